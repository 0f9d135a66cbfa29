#include "silpose/likelihood/coverage_raster.h"

#include <bit>

#include "silpose/base/check.h"

namespace silpose {
namespace {

int cells_along(int pixels, int cell) { return (pixels + cell - 1) / cell; }

}  // namespace

CoverageEvidence::Raster coverage_raster(const Observation& observation, int cell) {
  check(cell > 0, "coverage_raster: cells of {} pixels", cell);
  const Mask& mask = observation.mask;
  CoverageEvidence::Raster raster;
  raster.cell = cell;
  const int width = cells_along(mask.width(), cell), height = cells_along(mask.height(), cell);
  raster.observed = Image<float>(width, height);
  const float one_pixel = 1.0f / static_cast<float>(cell * cell);
  for (int y = observation.box.y; y < observation.box.y + observation.box.height; ++y) {
    const auto words = mask.row(y);
    const auto cells = raster.observed.row(y / cell);
    for (size_t w = 0; w < words.size(); ++w) {
      for (uint64_t bits = words[w]; bits != 0; bits &= bits - 1) {
        cells[static_cast<size_t>((static_cast<int>(64 * w) + std::countr_zero(bits)) / cell)] += one_pixel;
      }
    }
  }
  const Box& box = observation.box;
  raster.occupied = {box.x / cell, box.y / cell, (box.x + box.width - 1) / cell - box.x / cell + 1,
                     (box.y + box.height - 1) / cell - box.y / cell + 1};
  if (!observation.confidence.empty()) {
    check(observation.confidence.width() == mask.width() && observation.confidence.height() == mask.height(),
          "coverage_raster: confidence of {}x{} for a mask of {}x{}", observation.confidence.width(),
          observation.confidence.height(), mask.width(), mask.height());
    raster.confidence = Image<float>(width, height);
    for (int y = 0; y < mask.height(); ++y) {
      const auto row = observation.confidence.row(y);
      const auto cells = raster.confidence.row(y / cell);
      for (int x = 0; x < mask.width(); ++x) {
        cells[static_cast<size_t>(x / cell)] += static_cast<float>(row[static_cast<size_t>(x)]) * one_pixel / 255.0f;
      }
    }
  }
  return raster;
}

double outline_length(const Mask& mask) {
  int64_t borders = 0;
  for (int y = 0; y < mask.height(); ++y) {
    const auto row = mask.row(y);
    uint64_t last = 0;
    for (size_t w = 0; w < row.size(); ++w) {
      const uint64_t shifted = row[w] << 1 | last;
      uint64_t change = row[w] ^ shifted;
      if (w == 0) change &= ~uint64_t{1};
      if (w + 1 == row.size() && mask.width() % 64 != 0) change &= (uint64_t{1} << (mask.width() % 64)) - 1;
      borders += std::popcount(change);
      last = row[w] >> 63;
      if (y > 0) borders += std::popcount(row[w] ^ mask.row(y - 1)[w]);
    }
  }
  return static_cast<double>(borders) * 0.78539816339744831;  // steps of a line of random direction are 4 / pi too long
}

}  // namespace silpose
