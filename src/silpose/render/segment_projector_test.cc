#include "silpose/render/segment_projector.h"

#include <gtest/gtest.h>

namespace silpose {
namespace {

PinholeCamera camera_over_floor() { return look_at_camera(640, 480, 500, {0, 1.5, 4}, {0, 0.5, 0}); }

// How far a pixel lies from the nearest piece of a polyline.
double distance_to(const std::vector<Eigen::Vector2d>& line, const Eigen::Vector2d& pixel) {
  double least = 1e9;
  for (size_t i = 1; i < line.size(); ++i) {
    const Eigen::Vector2d along = line[i] - line[i - 1];
    const double at = std::clamp((pixel - line[i - 1]).dot(along) / along.squaredNorm(), 0.0, 1.0);
    least = std::min(least, (line[i - 1] + at * along - pixel).norm());
  }
  return least;
}

TEST(SegmentProjectorTest, EndsOfASegmentInViewAreTheirProjections) {
  const PinholeCamera camera = camera_over_floor();
  const auto line = SegmentProjector(camera)({-1, 0, 0}, {1, 0, 1});
  ASSERT_EQ(line.size(), 2);
  EXPECT_LT((line[0] - *camera.project({-1, 0, 0})).norm(), 1e-9);
  EXPECT_LT((line[1] - *camera.project({1, 0, 1})).norm(), 1e-9);
}

TEST(SegmentProjectorTest, ADistortedSegmentGoesThroughItsPoints) {
  PinholeCamera camera = camera_over_floor();
  camera.distortion = {-0.25, 0.08, 0.001, -0.002, 0};
  const auto line = SegmentProjector(camera)({-2, 0, 1}, {2, 0, 1});
  const Eigen::Vector2d straight_middle = (line.front() + line.back()) / 2;
  EXPECT_GT(distance_to(line, straight_middle), 2) << "the lens bends nothing";
  for (double x = -1.5; x <= 1.5; x += 0.1) {
    EXPECT_LT(distance_to(line, *camera.project({x, 0, 1})), 0.05) << "x = " << x;
  }
}

TEST(SegmentProjectorTest, WhatIsBehindTheCameraIsCutOff) {
  const PinholeCamera camera = camera_over_floor();
  const SegmentProjector projector(camera);
  EXPECT_TRUE(projector({-1, 0, 6}, {1, 0, 6}).empty());
  // From before the camera to far behind it: what is left goes down, out of the image's lower border.
  const auto line = projector({0.2, 0, 0}, {0.2, 0, 20});
  ASSERT_EQ(line.size(), 2);
  EXPECT_LT((line[0] - *camera.project({0.2, 0, 0})).norm(), 1e-9);
  EXPECT_GT(line[1].y(), 480);
  EXPECT_LT(line[1].y(), 480 * 1.1);
  EXPECT_LT(distance_to(line, *camera.project({0.2, 0, 1.5})), 1e-6);
}

TEST(SegmentProjectorTest, WhatIsBesideTheImageIsCutOffAlsoWhereTheLensWouldFoldItBack) {
  PinholeCamera camera = camera_over_floor();
  camera.distortion = {-0.15, 0, 0, 0, 0};
  // The polynomial brings this point back into the image, where nothing of it is.
  const Eigen::Vector3d far(9, 0, 0.2);
  const Eigen::Vector2d folded = *camera.project(far);
  ASSERT_LT(std::abs(folded.x() - 320), 320);
  const SegmentProjector projector(camera);
  EXPECT_TRUE(projector(far, {9.2, 0, 0.2}).empty());
  const auto line = projector({0, 0, 0.2}, far);
  ASSERT_FALSE(line.empty());
  for (size_t i = 1; i < line.size(); ++i) EXPECT_GT(line[i].x(), line[i - 1].x());
  EXPECT_GT(line.back().x(), 640);
}

}  // namespace
}  // namespace silpose
