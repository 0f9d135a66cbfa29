#include "silpose/fit/pose_spread.h"

#include <gtest/gtest.h>

#include <cmath>

#include "silpose/body/test_body.h"
#include "silpose/geometry/rigid3.h"

namespace silpose {
namespace {

// DOF 0-2 are root_tx, root_ty, root_tz; 3 is root_ry, which is periodic; 5 is middle_rz. Landmarks: root, middle, tip
// and tip_end, 0.8 m above the middle.
class PoseSpreadTest : public testing::Test {
 protected:
  const BodyModel body_ = make_test_body();
  const std::vector<double> zero_ = std::vector<double>(8, 0.0);
};

TEST_F(PoseSpreadTest, WhereTheRootIsDoesNotCountAboutTheRoot) {
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(8, 8);
  covariance(0, 0) = 0.04;    // root_tx
  covariance(5, 5) = 0.0001;  // middle_rz: tip_end swings along x, 0.8 m above it
  const LandmarkVariances variances = landmark_variances(body_, zero_, covariance);
  ASSERT_EQ(variances.in_world.size(), 4U);
  EXPECT_NEAR(variances.in_world[0].x(), 0.04, 1e-12);
  EXPECT_EQ(variances.about_root[0], Eigen::Vector3d::Zero());
  EXPECT_NEAR(variances.in_world[3].x(), 0.04 + 0.0001 * 0.64, 1e-9);
  EXPECT_NEAR(variances.about_root[3].x(), 0.0001 * 0.64, 1e-9);
}

TEST_F(PoseSpreadTest, IndependentErrorsAddUp) {
  PoseVariances sum{{1, 2}, {{{0, 0, 0}}, {{0, 0, 0}}}};
  const PoseVariances one{{3, 4}, {{{1, 2, 3}}, {{4, 5, 6}}}};
  sum += one, sum += one;
  EXPECT_EQ(sum.dofs, (std::vector<double>{7, 10}));
  EXPECT_EQ(sum.landmarks.in_world[0], Eigen::Vector3d(2, 4, 6));
  EXPECT_EQ(sum.landmarks.about_root[0], Eigen::Vector3d(8, 10, 12));
}

TEST_F(PoseSpreadTest, SpreadIsTheSquareRoot) {
  const PoseSpread spread = spread_of({{4, -1e-18}, {{{1, 4, 9}}, {{16, 25, 36}}}});
  EXPECT_EQ(spread.dofs, (std::vector<double>{2, 0}));
  EXPECT_EQ(spread.landmarks[0], Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(spread.landmarks_about_root[0], Eigen::Vector3d(4, 5, 6));
}

// The weighted variance sum w (x - c)^2, with c = 0.1 and x = 0.4, -0.3 of weights 0.25, 0.5.
TEST_F(PoseSpreadTest, ScatterIsTheWeightedVarianceAboutTheCentre) {
  std::vector<double> centre = zero_, near = zero_, far = zero_;
  centre[0] = 0.1, near[0] = 0.4, far[0] = -0.3;
  const PoseScatter scatter(body_, centre);
  PoseVariances sum = no_variances(8, body_);
  scatter.add(0.25, near, sum);
  scatter.add(0.5, far, sum);
  EXPECT_NEAR(sum.dofs[0], 0.25 * 0.09 + 0.5 * 0.16, 1e-15);
  for (size_t d = 1; d < 8; ++d) EXPECT_EQ(sum.dofs[d], 0) << d;
  for (size_t l = 0; l < 4; ++l) {  // the whole body moves along x, and nothing about its root
    EXPECT_NEAR(sum.landmarks.in_world[l].x(), 0.1025, 1e-12) << l;
    EXPECT_NEAR(sum.landmarks.about_root[l].norm(), 0, 1e-12) << l;
  }
}

// A heading of 170 degrees is 20 degrees from -170; an angle that is not periodic is taken as it is.
TEST_F(PoseSpreadTest, PeriodicAnglesAreTakenTheShortWayRound) {
  ASSERT_TRUE(body_.skeleton.dofs()[3].is_periodic);
  ASSERT_FALSE(body_.skeleton.dofs()[5].is_periodic);
  std::vector<double> centre = zero_, other = zero_;
  for (const size_t d : {size_t{3}, size_t{5}}) centre[d] = to_radians(170), other[d] = to_radians(-170);
  PoseVariances sum = no_variances(8, body_);
  PoseScatter(body_, centre).add(0.5, other, sum);
  EXPECT_NEAR(sum.dofs[3], 0.5 * std::pow(to_radians(20), 2), 1e-12);
  EXPECT_NEAR(sum.dofs[5], 0.5 * std::pow(to_radians(340), 2), 1e-12);
}

// The tip is 0.8 m above the middle joint: turned by `a` about z it moves by 0.8 (sin a, 1 - cos a).
TEST_F(PoseSpreadTest, LandmarksScatterInSpaceAndAboutTheRoot) {
  constexpr double kAngle = 0.5, kShift = 0.2;
  std::vector<double> other = zero_;
  other[2] = kShift, other[5] = kAngle;
  PoseVariances sum = no_variances(8, body_);
  PoseScatter(body_, zero_).add(0.3, other, sum);
  const double across = 0.8 * std::sin(kAngle), down = 0.8 * (1 - std::cos(kAngle));
  const Eigen::Vector3d about_root = 0.3 * Eigen::Vector3d(across * across, down * down, 0),
                        in_world = about_root + 0.3 * Eigen::Vector3d(0, 0, kShift * kShift);
  EXPECT_LT((sum.landmarks.about_root[3] - about_root).norm(), 1e-7);
  EXPECT_LT((sum.landmarks.in_world[3] - in_world).norm(), 1e-7);
  EXPECT_NEAR(sum.landmarks.in_world[0].z(), 0.3 * kShift * kShift, 1e-12);
}

// w (variance + offset^2): the variance of a mixture of two Gaussians.
TEST_F(PoseSpreadTest, OwnCovarianceAddsToTheScatter) {
  std::vector<double> other = zero_;
  other[0] = 0.3;
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(8, 8);
  covariance(0, 0) = 0.04;
  covariance(5, 5) = 0.0001;
  PoseVariances sum = no_variances(8, body_);
  PoseScatter(body_, zero_).add(0.5, other, covariance, sum);
  EXPECT_NEAR(sum.dofs[0], 0.5 * (0.04 + 0.09), 1e-15);
  EXPECT_NEAR(sum.dofs[5], 0.5 * 0.0001, 1e-15);
  EXPECT_NEAR(sum.landmarks.in_world[3].x(), 0.5 * (0.09 + 0.04 + 0.0001 * 0.64), 1e-9);
  EXPECT_NEAR(sum.landmarks.about_root[3].x(), 0.5 * 0.0001 * 0.64, 1e-9);
}

}  // namespace
}  // namespace silpose
