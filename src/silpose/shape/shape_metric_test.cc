// The contract of ShapeMetric, for every metric there is; a new one is one line at the end of the first part.
#include "silpose/shape/shape_metric.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "silpose/base/parallel.h"
#include "silpose/shape/normalised_silhouette.h"

namespace silpose {
namespace {

struct Case {
  std::string name;
  std::shared_ptr<const ShapeMetric> metric;
};

class ShapeMetricContract : public testing::TestWithParam<Case> {
 protected:
  static constexpr int kWidth = 48, kHeight = 40;
  static constexpr Window kWindow = {.width = kWidth, .height = kHeight};

  static Mask rectangle(int x0, int y0, int width, int height) {
    Mask mask(kWidth, kHeight);
    for (int y = y0; y < y0 + height; ++y) {
      for (int x = x0; x < x0 + width; ++x) mask.set(x, y);
    }
    return mask;
  }
  // As a backend would draw it for the metric.
  Mask drawn(const Mask& mask) const { return resample_mask(mask, metric().raster(kWindow)); }
  const ShapeMetric& metric() const { return *GetParam().metric; }
  std::vector<double> distances(const Mask& observed, const std::vector<Mask>& masks,
                                const Mask* ignored = nullptr) const {
    std::vector<Mask> on_raster;
    for (const Mask& mask : masks) on_raster.push_back(drawn(mask));
    std::vector<double> out(masks.size(), -1);
    metric().distances(*metric().describe(observed, ignored, kWindow), on_raster, out);
    return out;
  }
  const Mask seen_ = rectangle(12, 8, 16, 24);
};

TEST_P(ShapeMetricContract, TheObservedSilhouetteIsAtDistanceZeroAndNothingIsNearer) {
  const auto found =
      distances(seen_, {seen_, rectangle(12, 8, 16, 10), rectangle(12, 8, 24, 6), Mask(kWidth, kHeight)});
  EXPECT_NEAR(found[0], 0, 1e-12);
  for (size_t n = 1; n < found.size(); ++n) EXPECT_GT(found[n], 0) << n;
}

TEST_P(ShapeMetricContract, DegenerateSilhouettesHaveFiniteDistances) {
  Mask full(kWidth, kHeight), two = rectangle(2, 2, 3, 3);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) full.set(x, y);
  }
  for (int x = 30; x < 40; ++x) two.set(x, 30);
  const std::vector<Mask> masks = {Mask(kWidth, kHeight),
                                   rectangle(20, 20, 1, 1),
                                   rectangle(0, 5, kWidth, 1),
                                   rectangle(0, 0, 1, kHeight),
                                   full,
                                   two};
  for (const Mask& observed : masks) {
    for (const double distance : distances(observed, masks)) {
      EXPECT_TRUE(std::isfinite(distance));
      EXPECT_GE(distance, 0);
    }
  }
}

TEST_P(ShapeMetricContract, NeitherOrderNorThreadsChangeADistance) {
  std::vector<Mask> masks;
  for (int i = 0; i < 40; ++i) masks.push_back(rectangle(i % 20, i % 11, 8 + i % 5, 6 + i % 7));
  const auto forward = distances(seen_, masks);
  std::ranges::reverse(masks);
  auto backward = distances(seen_, masks);
  std::ranges::reverse(backward);
  EXPECT_EQ(forward, backward);
  const ThreadLimit limit(1);
  EXPECT_EQ(distances(seen_, masks).front(), forward.back());
}

TEST_P(ShapeMetricContract, IgnoredPixelsCountInNoSilhouette) {
  const Mask ignored = rectangle(0, 20, kWidth, 20);
  Mask lower = seen_;
  for (int y = 20; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) lower.set(x, y, (x + y) % 3 == 0);
  }
  const std::vector<Mask> masks = {seen_, lower, rectangle(12, 8, 16, 4)};
  const auto found = distances(seen_, masks, &ignored);
  EXPECT_EQ(found, distances(lower, masks, &ignored));
  EXPECT_NEAR(found[0], 0, 1e-12);
  EXPECT_EQ(found[1], found[0]);
  EXPECT_GT(found[2], 0);
}

TEST_P(ShapeMetricContract, RefusesWrongSizes) {
  const auto observed = metric().describe(seen_, nullptr, kWindow);
  std::vector<double> out(1);
  const std::vector<Mask> wrong = {Mask(3, 3)}, two = {drawn(seen_), drawn(seen_)};
  EXPECT_THROW(metric().distances(*observed, wrong, out), std::invalid_argument);
  EXPECT_THROW(metric().distances(*observed, two, out), std::invalid_argument);
  const Mask other(3, 3);
  EXPECT_THROW((void)metric().describe(seen_, &other, kWindow), std::invalid_argument);
  struct Foreign : ShapeMetric::Description {};
  const std::vector<Mask> one = {drawn(seen_)};
  EXPECT_THROW(metric().distances(Foreign(), one, out), std::invalid_argument);
}

INSTANTIATE_TEST_SUITE_P(All, ShapeMetricContract,
                         testing::Values(Case{"PixelCount", std::make_shared<AreaMetric>(AreaMetric::Unit::kPixels)},
                                         Case{"Coverage", std::make_shared<AreaMetric>(AreaMetric::Unit::kSamples)}),
                         [](const auto& tested) { return tested.param.name; });

TEST(AreaMetric, IsTheDifferenceOverTheSumOfAreas) {
  const AreaMetric metric(AreaMetric::Unit::kPixels);
  EXPECT_EQ(metric.distance({100, 100, 100}), 0);
  EXPECT_EQ(metric.distance({100, 60, 0}), 1);
  EXPECT_EQ(metric.distance({0, 0, 0}), 1);
  EXPECT_DOUBLE_EQ(metric.distance({100, 50, 50}), 50.0 / 150);
}

// A tenth of a pixel: samples see it, pixels do not.
TEST(AreaMetric, SamplesSeeAMotionOfLessThanAPixel) {
  const Window window{.width = 16, .height = 16};
  Mask seen(16, 16);
  for (int y = 4; y < 12; ++y) {
    for (int x = 4; x < 10; ++x) seen.set(x, y);
  }
  const AreaMetric pixels(AreaMetric::Unit::kPixels), samples(AreaMetric::Unit::kSamples);
  const auto moved = [&](const AreaMetric& metric, double by) {
    Window shifted = metric.raster(window);
    shifted.x0 -= by;
    const std::vector<Mask> mask = {resample_mask(seen, shifted)};
    double distance = -1;
    metric.distances(*metric.describe(seen, nullptr, window), mask, {&distance, 1});
    return distance;
  };
  EXPECT_EQ(moved(pixels, 0.25), 0);
  EXPECT_NEAR(moved(samples, 0.25), 0.25 / 6, 1e-9);  // 2 x 8 x .25 of 2 x 48 pixels
}

}  // namespace
}  // namespace silpose
