#include "silpose/fit/pose_prior.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "silpose/base/rng.h"
#include "silpose/body/test_body.h"
#include "silpose/human/human_for_test.h"

namespace silpose {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using Body = std::shared_ptr<const BodyModel>;

Body human() { return human_for_test(2500); }

VectorXd vector_of(const std::vector<double>& pose) {
  return Eigen::Map<const VectorXd>(pose.data(), std::ssize(pose));
}

struct Added {
  explicit Added(const PosePrior& pose_prior, const VectorXd& pose, double rest_weight = 0)
      : gradient(VectorXd::Zero(pose.size())), hessian(MatrixXd::Zero(pose.size(), pose.size())) {
    cost = pose_prior.add(pose, {rest_weight}, gradient, hessian);
  }
  VectorXd gradient;
  MatrixXd hessian;
  double cost = 0;
};

// Somewhere within the limits, low enough to reach through the floor.
VectorXd random_pose(const BodyModel& body, Rng& rng) {
  VectorXd pose = vector_of(standing_pose(body));
  for (Eigen::Index d = 0; d < pose.size(); ++d) {
    const Dof& dof = body.skeleton.dofs()[static_cast<size_t>(d)];
    pose[d] += dof.is_translation ? 0.3 * (rng.uniform() - 0.7) : dof.lower + (dof.upper - dof.lower) * rng.uniform();
  }
  return pose;
}

void expect_exact_gradient(const Body& body) {
  const PosePrior pose_prior(body, true);
  Rng rng(3);
  int costly = 0;
  for (int i = 0; i < 10; ++i) {
    const VectorXd pose = random_pose(*body, rng);
    const Added at(pose_prior, pose, 0.2);
    costly += at.cost > 10;
    for (Eigen::Index d = 0; d < pose.size(); ++d) {
      const VectorXd step = 1e-6 * VectorXd::Unit(pose.size(), d);
      const double slope = (Added(pose_prior, pose + step, 0.2).cost - Added(pose_prior, pose - step, 0.2).cost);
      EXPECT_NEAR(at.gradient[d], 0.5 * slope / 2e-6, 1e-4 * (1 + at.gradient.cwiseAbs().maxCoeff())) << i << " " << d;
    }
  }
  EXPECT_GE(costly, 3);
}

TEST(PosePrior, GradientAgreesWithFiniteDifferences) {
  expect_exact_gradient(human());
  expect_exact_gradient(std::make_shared<const BodyModel>(make_test_body()));
}

TEST(PosePrior, WhatIsUnusualCostsMoreButNeverTearsBack) {
  const PosePrior pose_prior(human(), false);
  const Skeleton& skeleton = human()->skeleton;
  const auto cost_of = [&](const char* dof, double degrees) {
    VectorXd pose = vector_of(standing_pose(*human()));
    pose[*skeleton.find_dof(dof)] += to_radians(degrees);
    return Added(pose_prior, pose, 1).cost - Added(pose_prior, pose, 0).cost;
  };
  EXPECT_EQ(cost_of("root_tx", 60), 0);                                    // a metre aside
  EXPECT_GT(cost_of("abdomen_rx", 20), 2 * cost_of("right_shin_rx", 20));  // a knee bends more than a back
  EXPECT_GT(cost_of("root_rx", 30), 1);
  EXPECT_NEAR(cost_of("root_rx", 330), cost_of("root_rx", -30), 1e-9);
  EXPECT_EQ(cost_of("root_ry", 120), 0);  // any heading will do
  const double near = cost_of("abdomen_rx", 5) - cost_of("abdomen_rx", 0);
  EXPECT_LT(cost_of("abdomen_rx", 40), 0.5 * 64 * near);
}

TEST(PosePrior, StandingAtRestCostsNothing) {
  for (const Body& body : {human(), std::make_shared<const BodyModel>(make_test_body())}) {
    const VectorXd pose = vector_of(standing_pose(*body));
    EXPECT_LT(Added(PosePrior(body, true), pose).cost, 1e-6);
  }
}

// Balls of 0.2 m, 0.3 m apart, overlap by 0.1 m; flesh yields 0.02 m; 0.02 m more cost 1.
TEST(PosePrior, OverlapWorkedByHand) {
  const auto balls = std::make_shared<const BodyModel>(make_ball_body());
  const PosePrior pose_prior(balls, true);
  EXPECT_EQ(Added(pose_prior, vector_of({0, 0, -0.57})).cost, 0);
  const VectorXd pose = vector_of({0, 0, -0.7});
  const Added at(pose_prior, pose);
  EXPECT_NEAR(at.cost, 16, 1.6);
  EXPECT_NEAR(at.gradient[2], -0.08 / 0.0004, 10);
  EXPECT_NEAR(at.hessian(2, 2), 1 / 0.0004, 1e-6);
  EXPECT_EQ(at.hessian(0, 0), 0);
}

TEST(PosePrior, AFloorThatIsElsewhereDoesNotPush) {
  const auto balls = std::make_shared<const BodyModel>(make_ball_body());
  for (const double sunk : {-0.3, -0.7}) {  // half, and wholly
    const Added at(PosePrior(balls, true), vector_of({sunk, 0, 0}));
    EXPECT_EQ(at.gradient[0], 0);
    EXPECT_EQ(at.cost, 0);
  }
}

TEST(PosePrior, FloorPushesUpWhatIsBelow) {
  const auto balls = std::make_shared<const BodyModel>(make_ball_body());
  const VectorXd sunk = vector_of({-0.04, 0, 0});
  EXPECT_EQ(Added(PosePrior(balls, false), sunk).cost, 0);
  const Added at(PosePrior(balls, true), sunk);
  EXPECT_GE(at.cost, 2 * 3.8);
  EXPECT_LT(at.gradient[0], 0);

  const Body body = human();
  const PosePrior pose_prior(body, true);
  VectorXd pose = vector_of(standing_pose(*body));
  const int ankle = *body->skeleton.find_dof("right_foot_rx");
  pose[ankle] -= 0.3;
  const auto lowest = [&] {
    double least = 1;
    for (const Eigen::Vector3f& x : skin_vertices(*body, {pose.data(), static_cast<size_t>(pose.size())})) {
      least = std::min(least, static_cast<double>(x.y()));
    }
    return least;
  };
  ASSERT_LT(lowest(), -0.02);
  for (int i = 0; i < 8; ++i) {
    Added step(pose_prior, pose);
    step.hessian.diagonal().array() += 1;
    pose -= step.hessian.ldlt().solve(step.gradient);
  }
  EXPECT_GT(lowest(), -0.005);
}

TEST(PosePrior, BeyondALimitCosts) {
  const Body body = human();
  const PosePrior pose_prior(body, false);
  VectorXd pose = vector_of(standing_pose(*body));
  const int knee = *body->skeleton.find_dof("left_shin_rx");
  const Dof& dof = body->skeleton.dofs()[static_cast<size_t>(knee)];
  pose[knee] = std::abs(dof.lower) < std::abs(dof.upper) ? dof.lower - 0.04 : dof.upper + 0.04;
  EXPECT_NEAR(Added(pose_prior, pose).cost, 4, 1e-6);
  EXPECT_GT(Added(pose_prior, pose, 1).cost, 4);
}

}  // namespace
}  // namespace silpose
