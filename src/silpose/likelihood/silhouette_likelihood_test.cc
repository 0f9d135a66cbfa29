#include "silpose/likelihood/silhouette_likelihood.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "silpose/body/test_body.h"

namespace silpose {
namespace {

class SilhouetteLikelihoodTest : public ::testing::Test {
 protected:
  struct Options {
    Comparison comparison = Comparison::kImage;
    AreaMetric::Unit unit = AreaMetric::Unit::kPixels;
    double sharpness = 40;
    int resolution = 128;
  };
  SilhouetteLikelihood make(const Options& options, const MakeRenderBackend& make_backend = make_cpu_backend) const {
    return SilhouetteLikelihood(
        {make_backend(body_, camera_)}, std::make_shared<const AreaMetric>(options.unit),
        {.comparison = options.comparison, .sharpness = options.sharpness, .resolution = options.resolution});
  }
  SilhouetteLikelihood make() const { return make(Options{}); }
  static std::vector<double> log_likelihood(const SilhouetteLikelihood& likelihood, const Observation& observation,
                                            const StateBatch& states) {
    std::vector<double> values(static_cast<size_t>(states.rows()));
    likelihood.add_log_likelihood(*likelihood.prepare({&observation, 1}), states, values);
    return values;
  }
  static std::vector<double> distances(const SilhouetteLikelihood& likelihood, const Observation& observation,
                                       const StateBatch& states) {
    std::vector<double> values(static_cast<size_t>(states.rows()));
    likelihood.distances(*likelihood.prepare({&observation, 1}), states, values);
    return values;
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
  for (const auto& [unit, resolution] : {std::pair(AreaMetric::Unit::kPixels, 320),
                                         {AreaMetric::Unit::kSamples, 320},
                                         {AreaMetric::Unit::kSamples, 60}}) {
    const auto likelihood = make({.unit = unit, .resolution = resolution});
    Observation known = observation;
    known.ignored = std::make_shared<const Mask>(ignored);
    const double clean = distances(likelihood, observe(pose_), batch({pose_}))[0];
    const double fooled = distances(likelihood, observation, batch({pose_}))[0];
    const double warned = distances(likelihood, known, batch({pose_}))[0];
    EXPECT_GT(fooled, 0.3);
    EXPECT_NEAR(warned, clean, resolution == 320 ? 0.01 : 0.03);
    EXPECT_GE(warned, 0);
  }
}

// What is counted while drawing is what the drawn silhouettes give. The reference backend counts nothing.
TEST_F(SilhouetteLikelihoodTest, CountingAndDrawingAgree) {
  Observation observation = observe(pose_);
  Mask ignored(320, 240);
  for (int y = 60; y < 90; ++y) {
    for (int x = 0; x < 320; ++x) ignored.set(x, y);
  }
  observation.ignored = std::make_shared<const Mask>(ignored);
  auto near = pose_, far = pose_, outside = pose_, broken = pose_;
  near[5] += 0.2;
  far[0] += 1.5;
  outside[0] += 30;
  broken[3] = std::nan("");
  const StateBatch states = batch({pose_, near, far, outside, broken});
  for (const Comparison comparison : {Comparison::kImage, Comparison::kCropped}) {
    for (const auto unit : {AreaMetric::Unit::kPixels, AreaMetric::Unit::kSamples}) {
      const Options options{.comparison = comparison, .unit = unit, .resolution = 64};
      const auto counted = log_likelihood(make(options), observation, states);
      const auto drawn = log_likelihood(make(options, make_reference_backend), observation, states);
      // Projected vertices are rounded in another order: a pixel here and there.
      for (size_t n = 0; n < counted.size(); ++n) EXPECT_NEAR(counted[n], drawn[n], 40 * 0.005) << n;
      EXPECT_EQ(counted[4], drawn[4]);
    }
  }
}

TEST_F(SilhouetteLikelihoodTest, TheTruePoseIsBestAndADisjointOneWorst) {
  const auto likelihood = make();
  const Observation observation = observe(pose_);
  auto near = pose_, far = pose_;
  near[5] += 0.2;
  far[0] += 1.5;
  const auto found = distances(likelihood, observation, batch({pose_, near, far}));
  EXPECT_LT(found[0], 0.02);  // drawn at the raster's resolution, observed at the image's
  EXPECT_GT(found[1], found[0] + 0.02);
  EXPECT_EQ(found[2], 1);
  const auto values = log_likelihood(likelihood, observation, batch({pose_, near, far}));
  for (size_t n = 0; n < 3; ++n) EXPECT_DOUBLE_EQ(values[n], -SilhouetteOptions{}.sharpness * found[n]);
}

TEST_F(SilhouetteLikelihoodTest, ExtraColumnsAreNotRead) {
  const auto likelihood = make();
  const Observation observation = observe(pose_);
  auto longer = pose_;
  longer.resize(16, std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(log_likelihood(likelihood, observation, batch({pose_})),
            log_likelihood(likelihood, observation, batch({longer})));
}

TEST_F(SilhouetteLikelihoodTest, CroppingForgetsPosition) {
  const auto likelihood = make({.comparison = Comparison::kCropped, .resolution = 64});
  const Observation observation = observe(pose_);
  auto moved = pose_, bent = pose_;
  moved[0] += 0.1;
  moved[1] -= 0.1;
  bent[5] -= 0.6;
  const auto found = distances(likelihood, observation, batch({pose_, moved, bent}));
  EXPECT_LT(found[0], 0.03);
  EXPECT_LT(found[1], 0.06);
  EXPECT_GT(found[2], 0.15);
}

TEST_F(SilhouetteLikelihoodTest, ACameraThatSawNothingAddsNothing) {
  const auto likelihood = make();
  Observation nothing;
  nothing.mask = Mask(320, 240);
  nothing.trust = {.overall = 0, .nothing_found = true};
  std::vector<double> values(1, 7.0);
  likelihood.add_log_likelihood(*likelihood.prepare({&nothing, 1}), batch({pose_}), values);
  EXPECT_EQ(values[0], 7);
}

TEST_F(SilhouetteLikelihoodTest, TrustScalesTheLogLikelihood) {
  const auto likelihood = make();
  Observation observation = observe(pose_);
  auto off = pose_;
  off[5] += 0.3;
  const auto full = log_likelihood(likelihood, observation, batch({off}));
  observation.trust.overall = 0.5;
  const auto half = log_likelihood(likelihood, observation, batch({off}));
  EXPECT_DOUBLE_EQ(half[0], full[0] / 2);
}

TEST_F(SilhouetteLikelihoodTest, WholePixelsHaveTheSameDistanceByEitherMetric) {
  // At the image's own resolution nothing observed is covered in part: what differs of whole pixels is the same.
  const auto count = make(), coverage = make({.unit = AreaMetric::Unit::kSamples, .resolution = 1024});
  Observation far = observe(pose_);
  auto disjoint = pose_;
  disjoint[0] += 1.5;
  const auto by_count = distances(count, far, batch({disjoint, pose_}));
  const auto by_coverage = distances(coverage, far, batch({disjoint, pose_}));
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
  const auto coverage = make({.unit = AreaMetric::Unit::kSamples, .resolution = kResolution});
  const auto count = make({.resolution = kResolution});
  const auto by_coverage = distances(coverage, observation, batch(poses));
  const auto by_count = distances(count, observation, batch(poses));
  int unmoved = 0;
  for (size_t k = 1; k < poses.size(); ++k) {
    EXPECT_GT(by_coverage[k], by_coverage[k - 1] + 0.003) << k;
    unmoved += by_count[k] <= by_count[k - 1];
  }
  EXPECT_GE(unmoved, 4);
  EXPECT_LT(by_coverage[0], 0.01);
}

TEST_F(SilhouetteLikelihoodTest, CroppedCoverageForgetsPosition) {
  const auto likelihood =
      make({.comparison = Comparison::kCropped, .unit = AreaMetric::Unit::kSamples, .resolution = 64});
  const Observation observation = observe(pose_);
  auto moved = pose_, bent = pose_;
  moved[0] += 0.1;
  bent[5] -= 0.6;
  const auto found = distances(likelihood, observation, batch({pose_, moved, bent}));
  EXPECT_LT(found[0], 0.03);
  EXPECT_LT(found[1], 0.06);
  EXPECT_GT(found[2], 0.15);
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
  EXPECT_THROW((void)distances(likelihood, observation, batch({{1, 2, 3}})), std::invalid_argument);
  EXPECT_THROW(SilhouetteLikelihood({}, std::make_shared<AreaMetric>(AreaMetric::Unit::kPixels), {}),
               std::invalid_argument);
  EXPECT_THROW(SilhouetteLikelihood({make_cpu_backend(body_, camera_)}, nullptr, {}), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
