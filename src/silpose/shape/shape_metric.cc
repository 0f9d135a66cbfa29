#include "silpose/shape/shape_metric.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "silpose/base/check.h"
#include "silpose/base/parallel.h"
#include "silpose/shape/normalised_silhouette.h"

namespace silpose {
namespace {

constexpr size_t kGrain = 16;  // [guess] silhouettes per task

// How much of each pixel samples cover, 0 to kFullCoverage.
ByteImage coverage_of(const Mask& samples) {
  ByteImage coverage(samples.width() / kCoverageSamples, samples.height() / kCoverageSamples);
  for (int y = 0; y < coverage.height() * kCoverageSamples; ++y) {
    for (int x = 0; x < coverage.width() * kCoverageSamples; ++x) {
      uint8_t& of_pixel = coverage.at(x / kCoverageSamples, y / kCoverageSamples);
      of_pixel = static_cast<uint8_t>(of_pixel + samples.get(x, y));
    }
  }
  return coverage;
}

int64_t sum_of(const ByteImage& coverage) {
  return std::accumulate(coverage.pixels().begin(), coverage.pixels().end(), int64_t{0});
}

int64_t sum_of_lesser(const ByteImage& a, const ByteImage& b) {
  int64_t sum = 0;
  for (size_t i = 0; i < a.pixels().size(); ++i) sum += std::min(a.pixels()[i], b.pixels()[i]);
  return sum;
}

AreaMetric::Areas areas_of(const AreaMetric::Described& observed, const Mask& mask) {
  if (observed.coverage.empty()) {
    const Mask known = observed.has_ignored() ? without(mask, observed.ignored) : mask;
    return {observed.area, known.count(), and_count(known, observed.mask)};
  }
  const ByteImage coverage = coverage_of(mask);
  const int64_t unknown = observed.has_ignored() ? sum_of_lesser(coverage, observed.ignored_coverage) : 0;
  return {observed.area, sum_of(coverage) - unknown, sum_of_lesser(coverage, observed.coverage)};
}

}  // namespace

double AreaMetric::distance(const Areas& areas) const {
  const int64_t sum = areas.model + areas.observed;
  return sum == 0 ? 1.0 : static_cast<double>(sum - 2 * areas.both) / static_cast<double>(sum);
}

Window AreaMetric::raster(const Window& window) const {
  return unit_ == Unit::kSamples ? sample_window(window) : window;
}

std::unique_ptr<const ShapeMetric::Description> AreaMetric::describe(const Mask& observed, const Mask* ignored,
                                                                     const Window& window) const {
  check(ignored == nullptr || (ignored->width() == observed.width() && ignored->height() == observed.height()),
        "AreaMetric: ignored pixels of another size than the mask of {}x{}", observed.width(), observed.height());
  auto raster = std::make_unique<Described>();
  if (unit_ == Unit::kPixels) {
    raster->mask = resample_mask(observed, window);
    if (ignored != nullptr) {
      raster->ignored = resample_mask(*ignored, window);
      raster->mask = without(std::move(raster->mask), raster->ignored);
    }
    raster->area = raster->mask.count();
    return raster;
  }
  raster->coverage = resample_coverage(observed, window, kFullCoverage);
  if (ignored != nullptr) {
    // Whole pixels of the window, also those that are ignored in part.
    raster->ignored_coverage = resample_coverage(*ignored, window, kFullCoverage);
    const auto covered = raster->coverage.pixels(), out = raster->ignored_coverage.pixels();
    for (size_t i = 0; i < covered.size(); ++i) {
      if (out[i] > 0) covered[i] = 0, out[i] = kFullCoverage;
    }
  }
  raster->area = sum_of(raster->coverage);
  return raster;
}

void AreaMetric::distances(const Description& observed, std::span<const Mask> masks, std::span<double> out) const {
  const auto* raster = dynamic_cast<const Described*>(&observed);
  check(raster != nullptr, "AreaMetric: a description by another metric");
  check(out.size() == masks.size(), "AreaMetric: {} masks, room for {}", masks.size(), out.size());
  const int finer = raster->coverage.empty() ? 1 : kCoverageSamples;
  const int width = raster->coverage.empty() ? raster->mask.width() : raster->coverage.width() * finer;
  const int height = raster->coverage.empty() ? raster->mask.height() : raster->coverage.height() * finer;
  for (const Mask& mask : masks) {
    check(mask.width() == width && mask.height() == height, "AreaMetric: a mask of {}x{} in place of {}x{}",
          mask.width(), mask.height(), width, height);
  }
  parallel_for(masks.size(), kGrain, [&](size_t begin, size_t end) {
    for (size_t n = begin; n < end; ++n) out[n] = distance(areas_of(*raster, masks[n]));
  });
}

}  // namespace silpose
