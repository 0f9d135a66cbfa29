#include "silpose/calibrate/person_camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

#include "silpose/geometry/rigid3.h"

namespace silpose {
namespace {

constexpr double kBodyHeight = 1.7;
const FocalPrior kUsual = usual_focal_length(640, 480);  // 480 px within 20 %

PinholeCamera camera_at(double focal_px, double height, double tilt_deg) {
  const double tilt = to_radians(tilt_deg);
  const Eigen::Vector3d camera_centre(0, height, 6);
  return look_at_camera(640, 480, focal_px, camera_centre,
                        camera_centre + Eigen::Vector3d(0, -std::sin(tilt), -std::cos(tilt)));
}

// A straight, thin person whose nearest foot is 0.22 m in front of its axis and who stoops by 2 %, twelve times per
// second.
PersonExtent extent_at(const PinholeCamera& camera, double x, double z, double time_s) {
  PersonExtent extent{time_s, camera.project({x, 0.98 * kBodyHeight, z}).value(), {}, 2.5};
  const Eigen::Vector2d axis = camera.project({x, 0, z}).value(), toe = camera.project({x, 0, z + 0.22}).value();
  extent.feet = {axis.x(), toe.y()};
  return extent;
}

// Walks a zigzag between `nearest` and `farthest` (z), across the image.
std::vector<PersonExtent> walk(const PinholeCamera& camera, double nearest, double farthest) {
  std::vector<PersonExtent> extents;
  for (int i = 0; i < 96; ++i) {
    const double way = std::abs(std::remainder(i / 24.0, 2.0));
    extents.push_back(extent_at(camera, -1.2 + 2.4 * i / 96, nearest + (farthest - nearest) * way, i / 12.0));
  }
  return extents;
}

void expect_inside(const Estimated& estimate, double truth, double deviations) {
  EXPECT_LT(std::abs(estimate.mean - truth), deviations * estimate.deviation)
      << estimate.mean << " +- " << estimate.deviation << ", truth " << truth;
}

TEST(EstimateCamera, FindsHeightAndTilt) {
  for (const double tilt_deg : {-8.0, 0.0, 12.0}) {
    for (const double height : {0.8, 2.2}) {
      const PinholeCamera truth = camera_at(540, height, tilt_deg);
      const auto estimate = estimate_camera(walk(truth, 1, -2), 640, 480, kBodyHeight, kUsual);
      ASSERT_TRUE(estimate);
      EXPECT_NEAR(estimate->height_m.mean, height, 0.05 * height);
      EXPECT_NEAR(to_degrees(estimate->tilt.mean), tilt_deg, 2.5);
      expect_inside(estimate->height_m, height, 1.5);
      expect_inside(estimate->tilt, to_radians(tilt_deg), 1.5);
      expect_inside(estimate->focal_px, 540, 1.5);
      // The camera is what is said of it, and sees the same.
      EXPECT_NEAR(estimate->camera.centre_in_world().y(), estimate->height_m.mean, 1e-9);
      EXPECT_NEAR(estimate->camera.fx, estimate->focal_px.mean, 1e-9);
      const Eigen::Vector3d ahead = estimate->camera.cam_from_world.rotation.row(2);
      EXPECT_NEAR(std::asin(-ahead.y()), estimate->tilt.mean, 1e-9);
    }
  }
}

TEST(EstimateCamera, HeightGrowsWithTheBody) {
  const auto extents = walk(camera_at(650, 1.2, 3), 1, -2);
  const auto small = estimate_camera(extents, 640, 480, kBodyHeight, kUsual);
  const auto large = estimate_camera(extents, 640, 480, 1.1 * kBodyHeight, kUsual);
  EXPECT_NEAR(large->height_m.mean / small->height_m.mean, 1.1, 0.02);
  EXPECT_EQ(large->body_height_m, 1.1 * kBodyHeight);
}

TEST(EstimateCamera, SaysHowLittleOneDepthTells) {
  const PinholeCamera truth = camera_at(560, 1.2, 8);
  const auto deep = estimate_camera(walk(truth, 1, -2), 640, 480, kBodyHeight, kUsual);
  const auto flat = estimate_camera(walk(truth, 0, 0), 640, 480, kBodyHeight, kUsual);
  EXPECT_GT(flat->height_m.deviation, 3 * deep->height_m.deviation);
  EXPECT_GT(flat->height_m.deviation, 0.2);
  expect_inside(flat->height_m, 1.2, 2);
  expect_inside(flat->tilt, to_radians(8), 2);
  expect_inside(flat->focal_px, 560, 2);
}

TEST(EstimateCamera, TiltAtTheImagesSidesTellsTheFocalLength) {
  for (const double focal_px : {330.0, 800.0}) {
    const double off = std::log(focal_px / kUsual.focal_px);
    const auto tilted = estimate_camera(walk(camera_at(focal_px, 2.2, 20), 1, -2), 640, 480, kBodyHeight, kUsual);
    EXPECT_GT(std::log(tilted->focal_px.mean / kUsual.focal_px) / off, 0.4);  // the way from the prior to the truth
    EXPECT_LT(tilted->focal_px.deviation, 0.15 * tilted->focal_px.mean);
    expect_inside(tilted->focal_px, focal_px, 2);
  }
}

TEST(EstimateCamera, FocalLengthThatNothingTellsStaysAtItsPrior) {
  for (const double focal_px : {400.0, 560.0}) {
    const auto level = estimate_camera(walk(camera_at(focal_px, 1.2, 0), 1, -2), 640, 480, kBodyHeight, kUsual);
    EXPECT_NEAR(level->focal_px.mean, kUsual.focal_px, 0.06 * kUsual.focal_px);
    EXPECT_GT(level->focal_px.deviation, 0.18 * level->focal_px.mean);
    expect_inside(level->focal_px, focal_px, 2);
  }
}

TEST(EstimateCamera, KnownFocalLengthIsKept) {
  const PinholeCamera truth = camera_at(900, 1.2, 8);
  const auto extents = walk(truth, 1, -2);
  const auto known = estimate_camera(extents, 640, 480, kBodyHeight, {900, 0});
  EXPECT_EQ(known->focal_px.mean, 900);
  EXPECT_EQ(known->focal_px.deviation, 0);
  EXPECT_EQ(known->camera.fx, 900);
  EXPECT_NEAR(known->height_m.mean, 1.2, 0.03);
  EXPECT_NEAR(to_degrees(known->tilt.mean), 8, 0.5);
  EXPECT_LT(known->tilt.deviation, 0.7 * estimate_camera(extents, 640, 480, kBodyHeight, {900, 0.2})->tilt.deviation);
  const auto wrong = estimate_camera(extents, 640, 480, kBodyHeight, {600, 0});
  EXPECT_EQ(wrong->focal_px.mean, 600);
  // The image determines the horizon: it stays where it is.
  EXPECT_NEAR(600 * std::tan(wrong->tilt.mean), 900 * std::tan(to_radians(8)), 12);
}

TEST(EstimateCamera, CrouchingForAWhileDoesNotRuinIt) {
  const PinholeCamera truth = camera_at(700, 1.4, 5);
  auto extents = walk(truth, 1, -2);
  for (size_t i = 30; i < 50; ++i) {
    extents[i].head.y() += 0.4 * extents[i].height();
    extents[i].slenderness = 2;
  }
  const auto estimate = estimate_camera(extents, 640, 480, kBodyHeight, kUsual);
  EXPECT_NEAR(estimate->height_m.mean, 1.4, 0.1);
  EXPECT_NEAR(to_degrees(estimate->tilt.mean), 5, 2.5);
}

TEST(EstimateCamera, NeedsSomeFrames) {
  auto extents = walk(camera_at(700, 1.4, 5), 1, -2);
  extents.resize(kFewestExtents - 1);
  EXPECT_FALSE(estimate_camera(extents, 640, 480, kBodyHeight, kUsual));
  EXPECT_THROW((void)estimate_camera(extents, 640, 480, 0, kUsual), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
