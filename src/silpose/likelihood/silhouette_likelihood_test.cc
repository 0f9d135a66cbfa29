#include "silpose/likelihood/silhouette_likelihood.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "silpose/body/test_body.h"

namespace silpose {
namespace {

class SilhouetteLikelihoodTest : public ::testing::Test {
 protected:
  SilhouetteLikelihood make(LikelihoodOptions options = {}) const {
    return SilhouetteLikelihood({std::make_shared<BatchRenderer>(body_, camera_)}, options);
  }
  Observation observe(std::span<const double> pose) const {
    Observation observation;
    observation.mask = render_silhouette(*body_, camera_, pose);
    return observation;
  }
  static StateBatch batch(const std::vector<std::vector<double>>& poses) {
    StateBatch states(static_cast<Eigen::Index>(poses.size()), static_cast<Eigen::Index>(poses.front().size()));
    for (size_t n = 0; n < poses.size(); ++n) {
      for (size_t d = 0; d < poses[n].size(); ++d) {
        states(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(d)) = poses[n][d];
      }
    }
    return states;
  }

  std::shared_ptr<const BodyModel> body_ = std::make_shared<BodyModel>(make_test_body());
  PinholeCamera camera_ = look_at_camera(320, 240, 300, {0, 1, 4}, {0, 0.75, 0});
  std::vector<double> pose_ = {0.1, 0.5, 0, 0, 0.2, 0.3, 0.1, -0.2};
};

// Half of the image says nothing: neither what is seen there, nor what a pose would show there, counts.
TEST_F(SilhouetteLikelihoodTest, IgnoredPixelsDoNotCount) {
  Observation observation = observe(pose_);
  const Box box = observation.box();
  Mask ignored(320, 240);
  for (int y = 0; y < 240; ++y) {
    for (int x = box.x + box.width / 2; x < 320; ++x) ignored.set(x, y), observation.mask.set(x, y, y % 2 == 0);
  }
  for (const auto& [metric, resolution] :
       {std::pair(Metric::kPixelCount, 320), {Metric::kCoverage, 320}, {Metric::kCoverage, 60}}) {
    const auto likelihood = make({.metric = metric, .resolution = resolution});
    double clean = 0, fooled = 0, warned = 0;
    likelihood.distances(likelihood.prepare(std::vector{observe(pose_)}), batch({pose_}), {&clean, 1});
    likelihood.distances(likelihood.prepare(std::vector{observation}), batch({pose_}), {&fooled, 1});
    Observation known = observation;
    known.ignored = std::make_shared<const Mask>(ignored);
    likelihood.distances(likelihood.prepare(std::vector{known}), batch({pose_}), {&warned, 1});
    EXPECT_GT(fooled, 0.3);
    EXPECT_NEAR(warned, clean, resolution == 320 ? 0.01 : 0.03);
    EXPECT_GE(warned, 0);
  }
}

TEST_F(SilhouetteLikelihoodTest, TheTruePoseIsBestAndADisjointOneWorst) {
  const auto likelihood = make();
  const Observation observation = observe(pose_);
  const Evidence evidence = likelihood.prepare({&observation, 1});
  auto near = pose_, far = pose_;
  near[5] += 0.2;
  far[0] += 1.5;
  std::vector<double> distances(3);
  likelihood.distances(evidence, batch({pose_, near, far}), distances);
  EXPECT_LT(distances[0], 0.02);  // drawn at the raster's resolution, observed at the image's
  EXPECT_GT(distances[1], distances[0] + 0.02);
  EXPECT_EQ(distances[2], 1);
  std::vector<double> values(3);
  likelihood.log_likelihood(evidence, batch({pose_, near, far}), values);
  for (size_t n = 0; n < 3; ++n) EXPECT_DOUBLE_EQ(values[n], -likelihood.options().sharpness * distances[n]);
}

TEST_F(SilhouetteLikelihoodTest, ExtraColumnsAreNotRead) {
  const auto likelihood = make();
  const Observation observation = observe(pose_);
  const Evidence evidence = likelihood.prepare({&observation, 1});
  auto longer = pose_;
  longer.resize(16, std::numeric_limits<double>::quiet_NaN());
  std::vector<double> plain(1), wide(1);
  likelihood.log_likelihood(evidence, batch({pose_}), plain);
  likelihood.log_likelihood(evidence, batch({longer}), wide);
  EXPECT_EQ(plain, wide);
}

TEST_F(SilhouetteLikelihoodTest, CroppingForgetsPosition) {
  const auto likelihood = make({.comparison = Comparison::kCropped, .resolution = 64});
  const Observation observation = observe(pose_);
  const Evidence evidence = likelihood.prepare({&observation, 1});
  auto moved = pose_, bent = pose_;
  moved[0] += 0.1;
  moved[1] -= 0.1;
  bent[5] -= 0.6;
  std::vector<double> distances(3);
  likelihood.distances(evidence, batch({pose_, moved, bent}), distances);
  EXPECT_LT(distances[0], 0.03);
  EXPECT_LT(distances[1], 0.06);
  EXPECT_GT(distances[2], 0.15);
}

TEST_F(SilhouetteLikelihoodTest, ACameraThatSawNothingHasNoSay) {
  const auto likelihood = make();
  Observation nothing;
  nothing.mask = Mask(320, 240);
  nothing.trust = {.overall = 0, .nothing_found = true};
  const Evidence evidence = likelihood.prepare({&nothing, 1});
  EXPECT_EQ(evidence.views[0].trust, 0);
  std::vector<double> values(1, 7.0);
  likelihood.log_likelihood(evidence, batch({pose_}), values);
  EXPECT_EQ(values[0], 0);
}

TEST_F(SilhouetteLikelihoodTest, TrustScalesTheSay) {
  const auto likelihood = make();
  Observation observation = observe(pose_);
  auto off = pose_;
  off[5] += 0.3;
  std::vector<double> full(1), half(1);
  likelihood.log_likelihood(likelihood.prepare({&observation, 1}), batch({off}), full);
  observation.trust.overall = 0.5;
  likelihood.log_likelihood(likelihood.prepare({&observation, 1}), batch({off}), half);
  EXPECT_DOUBLE_EQ(half[0], full[0] / 2);
}

TEST_F(SilhouetteLikelihoodTest, WholePixelsHaveTheSameDistanceByEitherMetric) {
  // At the picture's own resolution nothing observed is covered in part: what differs of whole pixels is the same.
  const auto count = make(), coverage = make({.metric = Metric::kCoverage, .resolution = 1024});
  Observation far = observe(pose_);
  auto disjoint = pose_;
  disjoint[0] += 1.5;
  std::vector<double> by_count(2), by_coverage(2);
  count.distances(count.prepare({&far, 1}), batch({disjoint, pose_}), by_count);
  coverage.distances(coverage.prepare({&far, 1}), batch({disjoint, pose_}), by_coverage);
  EXPECT_EQ(by_count[0], 1);
  EXPECT_EQ(by_coverage[0], 1);
  EXPECT_LT(by_coverage[1], 0.05);  // outlines cut pixels that were observed whole or not at all
}

TEST_F(SilhouetteLikelihoodTest, ATenthOfAPixelMovesTheCoverage) {
  camera_.width = 640, camera_.height = 480, camera_.fx = camera_.fy = 600, camera_.cx = 320, camera_.cy = 240;
  pose_ = {0.1, 0.5, 0, 0, 0, 0.02, 0, 0};  // limbs nearly upright: their outlines pass centres of pixels in one go
  const Observation observation = observe(pose_);
  constexpr int kResolution = 24;
  const double metres_per_raster_pixel =
      std::max(observation.box().width, observation.box().height) / double(kResolution) * 4 / camera_.fx;
  std::vector<std::vector<double>> poses;
  for (int k = 0; k <= 10; ++k) {
    poses.push_back(pose_);
    poses.back()[0] += 0.1 * k * metres_per_raster_pixel;
  }
  std::vector<double> by_coverage(poses.size()), by_count(poses.size());
  const auto coverage = make({.metric = Metric::kCoverage, .resolution = kResolution});
  const auto count = make({.resolution = kResolution});
  coverage.distances(coverage.prepare({&observation, 1}), batch(poses), by_coverage);
  count.distances(count.prepare({&observation, 1}), batch(poses), by_count);
  int unmoved = 0;
  for (size_t k = 1; k < poses.size(); ++k) {
    EXPECT_GT(by_coverage[k], by_coverage[k - 1] + 0.003) << k;
    unmoved += by_count[k] <= by_count[k - 1];
  }
  EXPECT_GE(unmoved, 4);
  EXPECT_LT(by_coverage[0], 0.01);
}

TEST_F(SilhouetteLikelihoodTest, CroppedCoverageForgetsPosition) {
  const auto likelihood = make({.comparison = Comparison::kCropped, .metric = Metric::kCoverage, .resolution = 64});
  const Observation observation = observe(pose_);
  auto moved = pose_, bent = pose_;
  moved[0] += 0.1;
  bent[5] -= 0.6;
  std::vector<double> distances(3);
  likelihood.distances(likelihood.prepare({&observation, 1}), batch({pose_, moved, bent}), distances);
  EXPECT_LT(distances[0], 0.03);
  EXPECT_LT(distances[1], 0.06);
  EXPECT_GT(distances[2], 0.15);
}

TEST_F(SilhouetteLikelihoodTest, TheDerivativePointsBackToTheTruth) {
  const auto likelihood = make();
  const Observation observation = observe(pose_);
  const Evidence evidence = likelihood.prepare({&observation, 1});
  std::vector<double> steps(8, 0.05);
  for (const int d : {0, 1, 5, 7}) {
    for (const double sign : {-1.0, 1.0}) {
      auto off = pose_;
      off[static_cast<size_t>(d)] += sign * 0.15;
      const auto derivative = likelihood.derivative(evidence, off, steps);
      EXPECT_LT(sign * derivative.gradient[d], 0) << "DOF " << d;
    }
  }
}

TEST_F(SilhouetteLikelihoodTest, RefusesTheWrongShapes) {
  const auto likelihood = make();
  Observation small;
  small.mask = Mask(10, 10);
  EXPECT_THROW((void)likelihood.prepare({&small, 1}), std::invalid_argument);
  EXPECT_THROW((void)likelihood.prepare({}), std::invalid_argument);
  EXPECT_THROW(make({.sharpness = std::nan("")}), std::invalid_argument);
  EXPECT_THROW(make({.resolution = 2}), std::invalid_argument);
  const Observation observation = observe(pose_);
  std::vector<double> out(1);
  EXPECT_THROW(likelihood.distances(likelihood.prepare({&observation, 1}), batch({{1, 2, 3}}), out),
               std::invalid_argument);
}

}  // namespace
}  // namespace silpose
