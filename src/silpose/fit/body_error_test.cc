#include "silpose/fit/body_error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "silpose/human/human_for_test.h"
#include "silpose/render/silhouette.h"

namespace silpose {
namespace {

class BodyErrorTest : public ::testing::Test {
 protected:
  PoseVariances variance(double noise, const std::vector<PinholeCamera>& cameras, double size_deviation = 0) const {
    const BodyError error(*body_, cameras, size_deviation);
    std::vector<Observation> observations;
    for (const PinholeCamera& camera : cameras) {
      Observation observation;
      observation.mask = render_silhouette(*body_, camera, pose_);
      observations.push_back(std::move(observation));
    }
    CoverageEvidence evidence = error.likelihood().evidence_of(observations, Blur::k4, Blur::k4);
    for (size_t c = 0; c < cameras.size(); ++c) {
      evidence.noise[c] = noise * std::pow(evidence.views[c].pixel_unit, 3);
    }
    CoverageLikelihood::Scratch scratch(error.likelihood());
    return error.variance(evidence, pose_, scratch);
  }

  std::shared_ptr<const BodyModel> body_ = human_for_test(800);
  std::vector<double> pose_ = standing_pose(*body_);
  PinholeCamera front_ = look_at_camera(640, 480, 700, {0, 1, 5}, {0, 0.9, 0});
  PinholeCamera side_ = look_at_camera(640, 480, 700, {5, 1, 0}, {0, 0.9, 0});
};

TEST_F(BodyErrorTest, AddsNothingWhereTheBodyFits) {
  for (const double v : variance(1, {front_}).dofs) EXPECT_EQ(v, 0);
}

TEST_F(BodyErrorTest, UncertainSizeWidensDepth) {
  const auto one = variance(40, {front_});
  const double depth = std::sqrt(one.dofs[2]), across = std::sqrt(one.dofs[0]);
  EXPECT_GT(depth, 0.02);  // metres: more than half a percent of 5 m
  EXPECT_LT(across, 0.3 * depth);
}

TEST_F(BodyErrorTest, UnknownSizeWidensDepthHoweverWellTheOutlineFits) {
  const auto one = variance(1, {front_}, 0.05);
  EXPECT_NEAR(std::sqrt(one.dofs[2]), 0.05 * 5, 0.01);  // root_tz, 5 m before the camera
  EXPECT_NEAR(std::sqrt(one.dofs[0]), 0, 0.01);
  for (size_t d = 3; d < one.dofs.size(); ++d) EXPECT_EQ(one.dofs[d], 0) << body_->skeleton.dofs()[d].name;
  const size_t head_top = landmark_names(*body_).size() - 5;
  ASSERT_EQ(landmark_names(*body_)[head_top], "head_top");
  EXPECT_NEAR(std::sqrt(one.landmarks.in_world[head_top].z()), 0.05 * 5, 0.02);
  EXPECT_NEAR(std::sqrt(one.landmarks.in_world[head_top].y()), 0.05 * (body_->height_m - 1), 0.01);
  const double above_root = landmark_positions(*body_, pose_)[head_top].y() - landmark_positions(*body_, pose_)[0].y();
  EXPECT_NEAR(std::sqrt(one.landmarks.about_root[head_top].y()), 0.05 * above_root, 1e-3);
  EXPECT_NEAR(std::sqrt(one.landmarks.about_root[head_top].z()), 0, 0.01) << "the root is as far away as the head";
  for (const double v : variance(1, {front_, side_}, 0.05).dofs) EXPECT_EQ(v, 0) << "two cameras determine the size";
}

TEST_F(BodyErrorTest, ASecondCameraHelps) {
  EXPECT_LT(variance(40, {front_, side_}).dofs[2], 0.25 * variance(40, {front_}).dofs[2]);
}

}  // namespace
}  // namespace silpose
