#include "silpose/shape/normalised_silhouette.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "silpose/base/check.h"

namespace silpose {
namespace {

// For each raster pixel along one axis: the source interval it covers, clipped to the source.
struct Interval {
  double begin = 0, end = 0;
};

std::vector<Interval> covered_intervals(double origin, double scale, int raster_size, int source_size) {
  std::vector<Interval> intervals(static_cast<size_t>(raster_size));
  for (int i = 0; i < raster_size; ++i) {
    const double limit = source_size;
    intervals[static_cast<size_t>(i)] = {std::clamp(origin + i / scale, 0.0, limit),
                                         std::clamp(origin + (i + 1) / scale, 0.0, limit)};
  }
  return intervals;
}

// Adds `weight` times the length of each interval's set part in one mask row to `coverage`.
void add_row_coverage(std::span<const uint64_t> words, int source_width, std::span<const Interval> columns,
                      double weight, std::vector<double>& before, std::span<double> coverage) {
  before[0] = 0;  // before[x]: set pixels left of x
  for (int x = 0; x < source_width; ++x) {
    const auto bit = (words[static_cast<size_t>(x) >> 6] >> (x & 63)) & 1;
    before[static_cast<size_t>(x) + 1] = before[static_cast<size_t>(x)] + static_cast<double>(bit);
  }
  const auto set_before = [&](double x) {
    const auto whole = std::min(static_cast<size_t>(x), static_cast<size_t>(source_width - 1));
    return before[whole] + (x - static_cast<double>(whole)) * (before[whole + 1] - before[whole]);
  };
  for (size_t i = 0; i < columns.size(); ++i) {
    coverage[i] += weight * (set_before(columns[i].end) - set_before(columns[i].begin));
  }
}

}  // namespace

Window window_of(const PixelBounds& bounds, int width, int height) {
  check(width > 0 && height > 0, "window_of: size {}x{}", width, height);
  constexpr double kSmallestExtent = 1e-3;
  return {.x0 = bounds.x0,
          .y0 = bounds.y0,
          .scale_x = width / std::max(bounds.x1 - bounds.x0, kSmallestExtent),
          .scale_y = height / std::max(bounds.y1 - bounds.y0, kSmallestExtent),
          .width = width,
          .height = height};
}

Window window_of(const Box& box, int width, int height) {
  return window_of(PixelBounds{.x0 = static_cast<double>(box.x),
                               .y0 = static_cast<double>(box.y),
                               .x1 = static_cast<double>(box.x + box.width),
                               .y1 = static_cast<double>(box.y + box.height)},
                   width, height);
}

Window window_of_image(int image_width, int image_height, double scale) {
  check(image_width > 0 && image_height > 0 && scale > 0, "window_of_image: {}x{} at scale {}", image_width,
        image_height, scale);
  return {.scale_x = scale,
          .scale_y = scale,
          .width = static_cast<int>(std::ceil(image_width * scale)),
          .height = static_cast<int>(std::ceil(image_height * scale))};
}

namespace {

void check_window(const Window& window) {
  check(window.width > 0 && window.height > 0 && window.scale_x > 0 && window.scale_y > 0,
        "resample: window of {}x{} at scale {}, {}", window.width, window.height, window.scale_x, window.scale_y);
}

// Calls visit(row, coverage [window.width]) for every row of a window that `mask` may cover, each pixel's covered part
// in square pixels of the mask.
template <class Visit>
void for_each_covered_row(const Mask& mask, const Window& window, Visit&& visit) {
  const Box box = mask.bounding_box();
  if (box.empty()) return;
  const auto columns = covered_intervals(window.x0, window.scale_x, window.width, mask.width());
  const auto rows = covered_intervals(window.y0, window.scale_y, window.height, mask.height());
  std::vector<double> coverage(static_cast<size_t>(window.width));
  std::vector<double> before(static_cast<size_t>(mask.width()) + 1);
  for (int j = 0; j < window.height; ++j) {
    const auto [begin, end] = rows[static_cast<size_t>(j)];
    std::ranges::fill(coverage, 0.0);
    const int first = std::max(static_cast<int>(begin), box.y);
    for (int y = first; y < end && y < box.y + box.height; ++y) {
      const double weight = std::min(end, y + 1.0) - std::max(begin, static_cast<double>(y));
      if (weight > 0) add_row_coverage(mask.row(y), mask.width(), columns, weight, before, coverage);
    }
    visit(j, coverage);
  }
}

}  // namespace

Mask resample_mask(const Mask& mask, const Window& window) {
  check_window(window);
  Mask result(window.width, window.height);
  // A hair below one half, so that rounding cannot unset what is covered exactly by half.
  const double enough = (0.5 - 1e-9) / (window.scale_x * window.scale_y);
  for_each_covered_row(mask, window, [&](int y, const std::vector<double>& coverage) {
    const auto words = result.row(y);
    for (size_t i = 0; i < coverage.size(); ++i) words[i >> 6] |= uint64_t{coverage[i] >= enough} << (i & 63);
  });
  return result;
}

ByteImage resample_coverage(const Mask& mask, const Window& window, int whole) {
  check(whole >= 1 && whole <= 255, "resample_coverage: {} for a whole pixel", whole);
  check_window(window);
  ByteImage result(window.width, window.height);
  const double per_area = whole * window.scale_x * window.scale_y;
  for_each_covered_row(mask, window, [&](int y, const std::vector<double>& coverage) {
    const auto row = result.row(y);
    for (size_t i = 0; i < coverage.size(); ++i) row[i] = static_cast<uint8_t>(std::lround(coverage[i] * per_area));
  });
  return result;
}

Mask normalised_silhouette(const Mask& mask, int width, int height) {
  const Box box = mask.bounding_box();
  if (box.empty()) return Mask(width, height);
  return resample_mask(mask, window_of(box, width, height));
}

}  // namespace silpose
