#include "silpose/evaluate/pose_error.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "silpose/base/rng.h"
#include "silpose/body/test_body.h"

namespace silpose {
namespace {

// root_tx root_ty root_tz root_ry (periodic) middle_rx middle_rz tip_rx tip_rz
TEST(PoseError, ByHand) {
  const BodyModel body = make_test_body();
  const Skeleton& skeleton = body.skeleton;
  std::vector<double> truth(8, 0.0), pose = truth;
  EXPECT_EQ(pose_error_npsu(skeleton, pose, truth), 0);
  EXPECT_EQ(pose_error_deg(skeleton, pose, truth), 0);
  pose[0] = 1;  // translations count in NPSU alone
  pose[4] = to_radians(3);
  pose[7] = to_radians(-4);
  EXPECT_NEAR(pose_error_deg(skeleton, pose, truth), 5, 1e-12);
  EXPECT_NEAR(angle_error_deg(skeleton, pose, truth), 7.0 / 5, 1e-12);
  const auto share = [&](size_t d) { return pose[d] / (skeleton.dofs()[d].upper - skeleton.dofs()[d].lower); };
  EXPECT_NEAR(pose_error_npsu(skeleton, pose, truth), std::hypot(share(0), share(4), share(7)), 1e-12);
  EXPECT_THROW((void)pose_error_deg(skeleton, std::vector<double>(7), truth), std::invalid_argument);
}

TEST(PoseError, WholeTurnsAreNoDifference) {
  const BodyModel body = make_test_body();
  std::vector<double> truth(8, 0.0), pose = truth;
  truth[3] = to_radians(179);
  pose[3] = to_radians(-179);
  EXPECT_NEAR(pose_error_deg(body.skeleton, pose, truth), 2, 1e-9);
  EXPECT_NEAR(angle_error_deg(body.skeleton, pose, truth), 2.0 / 5, 1e-9);
  EXPECT_NEAR(pose_error_npsu(body.skeleton, pose, truth), 2.0 / 360, 1e-9);
}

TEST(MeanDistance, ByHand) {
  Eigen::MatrixXd points(3, 2), truth(3, 2);
  points << 0, 1, 0, 1, 0, 1;
  truth << 3, 1, 4, 1, 0, 2;
  EXPECT_NEAR(mean_distance(points, truth), 3, 1e-12);
  EXPECT_THROW((void)mean_distance(points, truth.leftCols(1)), std::invalid_argument);
}

TEST(AlignedDistance, IsZeroUpToASimilarityAndSmallerThanAnyOther) {
  Rng rng(3);
  Eigen::Matrix3Xd truth(3, 13);
  for (double& value : truth.reshaped()) value = rng.normal();
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(2.1, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  const Eigen::Matrix3Xd moved = ((1.7 * turn * truth).colwise() + Eigen::Vector3d(4, 5, -6)).eval();
  EXPECT_NEAR(aligned_distance(moved, truth).value(), 0, 1e-9);
  EXPECT_GT(mean_distance(moved, truth), 5);
}

TEST(AlignedDistance, DoesNotMirror) {
  Eigen::Matrix3Xd truth(3, 4), mirrored(3, 4);
  truth << 0, 1, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3;
  mirrored = truth;
  mirrored.row(0) *= -1;
  EXPECT_GT(aligned_distance(mirrored, truth).value(), 0.1);
}

TEST(AlignedDistance, NeedsThreePointsApart) {
  const Eigen::Matrix3Xd two = Eigen::Matrix3Xd::Random(3, 2), three = Eigen::Matrix3Xd::Random(3, 3);
  EXPECT_FALSE(aligned_distance(two, two).has_value());
  EXPECT_FALSE(aligned_distance(Eigen::Matrix3Xd::Ones(3, 3), three).has_value());
}

TEST(FlexionDeg, ByHand) {
  const Eigen::Vector3d hip(0, 2, 0), knee(0, 1, 0);
  EXPECT_NEAR(flexion_deg(hip, knee, {0, -3, 0}).value(), 0, 1e-12);
  EXPECT_NEAR(flexion_deg(hip, knee, {0, 1, -5}).value(), 90, 1e-12);
  EXPECT_NEAR(flexion_deg(hip, knee, {0, 2, 1}).value(), 135, 1e-12);
  EXPECT_NEAR(flexion_deg(hip, knee, {1e-5, -3, 0}).value(), to_degrees(1e-5 / 4), 1e-9);
  EXPECT_FALSE(flexion_deg(hip, knee, knee).has_value());
}

}  // namespace
}  // namespace silpose
