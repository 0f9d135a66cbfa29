#include "silpose/body/collision_spheres.h"

#include <gtest/gtest.h>

#include <cmath>

#include "silpose/body/point_motion.h"
#include "silpose/body/test_body.h"

namespace silpose {
namespace {

TEST(Flesh, ABallIsOneSphere) {
  const std::vector<CollisionSphere> spheres = collision_spheres(make_ball_body());
  ASSERT_EQ(spheres.size(), 2u);
  for (int j = 0; j < 2; ++j) {
    const CollisionSphere& sphere = spheres[static_cast<size_t>(j)];
    EXPECT_EQ(sphere.joint_idx, j);
    EXPECT_NEAR(sphere.radius, 0.2, 0.002);
    EXPECT_LT(sphere.centre_in_joint.norm(), 0.002);
  }
}

TEST(Flesh, SpheresHoldNoVertexAndEveryBoneHasOne) {
  const BodyModel body = make_test_body();
  std::vector<int> count(body.skeleton.joints().size(), 0);
  for (const CollisionSphere& sphere : collision_spheres(body)) {
    const auto j = static_cast<size_t>(sphere.joint_idx);
    ++count[j];
    const Eigen::Vector3d centre = body.joint_from_rest[j].inverse() * sphere.centre_in_joint;
    for (const Eigen::Vector3f& vertex : body.rest.vertices) {
      EXPECT_GE((vertex.cast<double>() - centre).norm(), sphere.radius - 1e-5);
    }
  }
  for (const int spheres : count) EXPECT_GE(spheres, 1);
}

TEST(Flesh, CentresOfTwoBallsAreTheirJoints) {
  const auto centres = segment_centres(make_ball_body());
  ASSERT_EQ(centres.size(), 2u);
  for (const auto& centre : centres) EXPECT_LT(centre.value().norm(), 0.005);
}

// Bones meet half-way between the rings of vertices that belong to one and to the next: at 0.75 and 1.15 m of 1.5.
TEST(Flesh, CentresOfATubeLieInTheMiddleOfItsBones) {
  const BodyModel body = make_test_body();
  const PointMotion motion(body.skeleton, standing_pose(body));
  const auto centres = segment_centres(body);
  const double heights[] = {0.375, 0.95, 1.325};
  for (int j = 0; j < 3; ++j) {
    const Eigen::Vector3d x = motion.position(j, centres[static_cast<size_t>(j)].value());
    EXPECT_LT((x - Eigen::Vector3d(0, heights[j], 0)).norm(), 0.03) << j;
  }
}

TEST(Flesh, OutermostPointsReachTheEndsOfTheBody) {
  const BodyModel body = make_test_body();
  const PointMotion motion(body.skeleton, standing_pose(body));
  Eigen::Vector3d lowest(9, 9, 9), highest(-9, -9, -9);
  for (const SkinPoint& point : outermost_points(body)) {
    const Eigen::Vector3d x = motion.position(point.joint_idx, point.x_in_joint);
    lowest = lowest.cwiseMin(x);
    highest = highest.cwiseMax(x);
  }
  EXPECT_LT((lowest - Eigen::Vector3d(-0.15, 0, -0.15)).norm(), 1e-4);
  EXPECT_LT((highest - Eigen::Vector3d(0.15, 1.5, 0.15)).norm(), 1e-4);
}

}  // namespace
}  // namespace silpose
