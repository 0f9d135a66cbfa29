#include "silpose/likelihood/coverage_raster.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <utility>
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

// Weights the cells by the confidence of their pixels, and by how many of these are known. Where some are ignored, what
// is observed becomes the share of those that are known: a body that covers the whole cell agrees with it.
void add_weights(const Observation& observation, CoverageEvidence::Raster& raster) {
  const int width = observation.mask.width(), height = observation.mask.height(), cell = raster.cell;
  const float one_weight = 1.0f / static_cast<float>(cell * cell) / 255.0f;
  raster.confidence.resize(raster.observed.size());
  std::vector<uint8_t> weights(static_cast<size_t>(width), 255), ignored(weights.size(), 0);
  std::vector<int> num_ignored(static_cast<size_t>(raster.width));
  for (int y = 0; y < height; ++y) {
    if (!observation.confidence.empty()) {
      std::ranges::transform(observation.confidence.row(y), weights.begin(), pixel_weight);
    }
    if (observation.ignored) bytes_from_bits(observation.ignored->row(y), ignored);
    for (int cell_x = 0, x = 0; cell_x < raster.width; ++cell_x) {
      int sum = 0;
      for (const int end = std::min(x + cell, width); x < end; ++x) {
        const auto i = static_cast<size_t>(x);
        sum += ignored[i] != 0 ? 0 : weights[i];
        num_ignored[static_cast<size_t>(cell_x)] += ignored[i] != 0 ? 1 : 0;
      }
      raster.confidence[raster.at(cell_x, y / cell)] += static_cast<float>(sum) * one_weight;
    }
    if ((y + 1) % cell != 0 && y + 1 < height) continue;
    for (int cell_x = 0; cell_x < raster.width; ++cell_x) {
      const int pixels = (std::min((cell_x + 1) * cell, width) - cell_x * cell) * (y % cell + 1);
      const int known = pixels - std::exchange(num_ignored[static_cast<size_t>(cell_x)], 0);
      if (known > 0 && known < pixels) {
        raster.observed[raster.at(cell_x, y / cell)] *= static_cast<float>(pixels) / static_cast<float>(known);
      }
    }
  }
}

}  // namespace

CoverageEvidence::Raster coverage_raster(const Observation& observation, int cell) {
  check(cell > 0, "coverage_raster: cells of {} pixels", cell);
  check_sizes(observation);
  const Mask cut = observation.ignored ? observation.known(observation.mask) : Mask();
  const Mask& known = observation.ignored ? cut : observation.mask;
  CoverageEvidence::Raster raster;
  raster.cell = cell;
  raster.width = cells_along(known.width(), cell);
  raster.height = cells_along(known.height(), cell);
  raster.observed.resize(raster.at(raster.width, 0));
  const float one_pixel = 1.0f / static_cast<float>(cell * cell);
  const Box box = known.bounding_box();
  if (!box.empty()) {
    raster.occupied = {box.x / cell, box.y / cell, (box.x + box.width - 1) / cell - box.x / cell + 1,
                       (box.y + box.height - 1) / cell - box.y / cell + 1};
  }
  for (int y = box.y; y < box.y + box.height; ++y) {
    const auto words = known.row(y);
    for (int x = raster.occupied.x; x < raster.occupied.x + raster.occupied.width; ++x) {
      raster.observed[raster.at(x, y / cell)] +=
          one_pixel * static_cast<float>(count_set(words, x * cell, (x + 1) * cell));
    }
  }
  if (!observation.confidence.empty() || observation.ignored) add_weights(observation, raster);
  return raster;
}

}  // namespace silpose
