#include "silpose/track/pose_estimate.h"

#include <gtest/gtest.h>

#include "silpose/body/test_body.h"

namespace silpose {
namespace {

TEST(LandmarkVariances, WhereTheRootIsDoesNotCountAboutTheRoot) {
  const BodyModel body = make_test_body();
  const std::vector<double> pose(8, 0.0);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(8, 8);
  covariance(0, 0) = 0.04;    // root_tx
  covariance(5, 5) = 0.0001;  // middle_rz: tip_end swings along x, 0.8 m above it
  const LandmarkVariances variances = landmark_variances(body, pose, covariance);
  ASSERT_EQ(variances.in_world.size(), 4U);
  EXPECT_NEAR(variances.in_world[0].x(), 0.04, 1e-12);
  EXPECT_EQ(variances.about_root[0], Eigen::Vector3d::Zero());
  EXPECT_NEAR(variances.in_world[3].x(), 0.04 + 0.0001 * 0.64, 1e-9);
  EXPECT_NEAR(variances.about_root[3].x(), 0.0001 * 0.64, 1e-9);
}

TEST(LandmarkVariances, AddUpWhereErrorsAreIndependent) {
  LandmarkVariances sum = no_landmark_variances(1);
  const LandmarkVariances one{{{1, 2, 3}}, {{4, 5, 6}}};
  sum += one, sum += one;
  EXPECT_EQ(sum.in_world[0], Eigen::Vector3d(2, 4, 6));
  EXPECT_EQ(sum.about_root[0], Eigen::Vector3d(8, 10, 12));
}

}  // namespace
}  // namespace silpose
