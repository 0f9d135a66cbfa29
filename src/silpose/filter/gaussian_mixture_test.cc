#include "silpose/filter/gaussian_mixture.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <vector>

namespace silpose {
namespace {

GaussianComponent one_dof(double pose, double velocity) {
  const std::vector<double> mean = {pose}, deviation = {0.5}, speed = {2.0};
  GaussianComponent component = component_at(mean, deviation, speed);
  component.mean[1] = velocity;
  return component;
}

TEST(ConstantVelocity, MovesMeanAndGrowsCovariance) {
  GaussianComponent component = one_dof(1, 3);
  const std::vector<double> still = {0.0};
  predict_constant_velocity(component, 0.5, still, 0.1);
  EXPECT_DOUBLE_EQ(component.mean[0], 2.5);
  EXPECT_DOUBLE_EQ(component.mean[1], 3);
  EXPECT_DOUBLE_EQ(component.covariance(0, 0), 0.25 + 0.25 * 4);
  EXPECT_DOUBLE_EQ(component.covariance(0, 1), 2);
  EXPECT_DOUBLE_EQ(component.covariance(1, 1), 4);
}

TEST(ConstantVelocity, ManySmallStepsAreOneLargeOne) {
  GaussianComponent once = one_dof(0, 1), often = once;
  const std::vector<double> acceleration = {0.3};
  predict_constant_velocity(once, 0.4, acceleration, 0.1);
  for (int i = 0; i < 8; ++i) predict_constant_velocity(often, 0.05, acceleration, 0.1);
  EXPECT_TRUE(once.mean.isApprox(often.mean, 1e-12));
  EXPECT_TRUE(once.covariance.isApprox(often.covariance, 1e-12));
}

TEST(ConstantVelocity, DecayBringsItToRest) {
  GaussianComponent component = one_dof(0, 1);
  const std::vector<double> still = {0.0};
  predict_constant_velocity(component, 100, still, 0.1, 2);
  EXPECT_NEAR(component.mean[0], 0.5, 1e-9);
  EXPECT_NEAR(component.mean[1], 0, 1e-9);
}

// Against a Kalman filter written out: a position is measured with variance r.
TEST(ConditionOnPose, IsTheKalmanUpdate) {
  GaussianComponent component = one_dof(0.2, 1);
  const std::vector<double> acceleration = {0.3};
  predict_constant_velocity(component, 0.2, acceleration, 0.1);
  const Eigen::Vector2d x = component.mean;
  const Eigen::Matrix2d P = component.covariance;
  const double r = 0.04, z = 0.9;
  const Eigen::Vector2d gain = P.col(0) / (P(0, 0) + r);
  const Eigen::Vector2d expected = x + gain * (z - x[0]);
  const Eigen::Matrix2d covariance = P - gain * P.row(0);

  const double information = 1 / P(0, 0) + 1 / r;
  const Eigen::VectorXd pose = Eigen::VectorXd::Constant(1, (x[0] / P(0, 0) + z / r) / information);
  condition_on_pose(component, pose, Eigen::MatrixXd::Constant(1, 1, information));
  EXPECT_TRUE(component.mean.isApprox(expected, 1e-12));
  EXPECT_TRUE(component.covariance.isApprox(covariance, 1e-12));
}

TEST(ConditionOnPose, RefusesOtherSizes) {
  GaussianComponent component = one_dof(0, 0);
  EXPECT_THROW(condition_on_pose(component, Eigen::VectorXd::Zero(2), Eigen::MatrixXd::Identity(2, 2)),
               std::invalid_argument);
}

}  // namespace
}  // namespace silpose
