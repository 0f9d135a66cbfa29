#include "silpose/likelihood/coverage_raster.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

#include "silpose/base/check.h"

namespace silpose {
namespace {

int cells_along(int pixels, int cell) { return (pixels + cell - 1) / cell; }

// Bits [begin, end) of a row, as far as it has them.
int count_set(std::span<const uint64_t> words, int begin, int end) {
  int count = 0;
  for (int x = begin; x < end;) {
    const auto word = static_cast<size_t>(x) / 64;
    if (word >= words.size()) break;
    const int first = x % 64, last = std::min(64, first + end - x);
    count += std::popcount(words[word] << (64 - last) >> (64 - last + first));
    x += last - first;
  }
  return count;
}

}  // namespace

CoverageEvidence::Raster coverage_raster(const Observation& observation, int cell) {
  check(cell > 0, "coverage_raster: cells of {} pixels", cell);
  const Mask& mask = observation.mask;
  CoverageEvidence::Raster raster;
  raster.cell = cell;
  raster.width = cells_along(mask.width(), cell);
  raster.height = cells_along(mask.height(), cell);
  raster.observed.resize(raster.at(raster.width, 0));
  const float one_pixel = 1.0f / static_cast<float>(cell * cell);
  const Box box = observation.box();
  raster.occupied = {box.x / cell, box.y / cell, (box.x + box.width - 1) / cell - box.x / cell + 1,
                     (box.y + box.height - 1) / cell - box.y / cell + 1};
  for (int y = box.y; y < box.y + box.height; ++y) {
    const auto words = mask.row(y);
    for (int x = raster.occupied.x; x < raster.occupied.x + raster.occupied.width; ++x) {
      raster.observed[raster.at(x, y / cell)] +=
          one_pixel * static_cast<float>(count_set(words, x * cell, (x + 1) * cell));
    }
  }
  if (observation.confidence.empty() && !observation.ignored) return raster;
  check_sizes(observation);
  raster.confidence.resize(raster.observed.size());
  std::vector<uint8_t> weights(static_cast<size_t>(mask.width()), 255), ignored(weights.size());
  for (int y = 0; y < mask.height(); ++y) {
    if (!observation.confidence.empty())
      std::ranges::transform(observation.confidence.row(y), weights.begin(), pixel_weight);
    if (observation.ignored) {
      bytes_from_bits(observation.ignored->row(y), ignored);
      for (size_t x = 0; x < weights.size(); ++x) {
        if (ignored[x] != 0)
          weights[x] = 0;
        else if (observation.confidence.empty())
          weights[x] = 255;
      }
    }
    for (int cell_x = 0, x = 0; cell_x < raster.width; ++cell_x) {
      int sum = 0;
      for (const int end = std::min(x + cell, mask.width()); x < end; ++x) sum += weights[static_cast<size_t>(x)];
      raster.confidence[raster.at(cell_x, y / cell)] += static_cast<float>(sum) * (one_pixel / 255.0f);
    }
  }
  return raster;
}

}  // namespace silpose
