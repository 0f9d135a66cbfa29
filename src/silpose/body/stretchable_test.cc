#include "silpose/body/stretchable.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "silpose/body/human.h"

namespace silpose {
namespace {

const BodyModel& human() {
  static const BodyModel body = build_human(MakeHumanData::load(SILPOSE_DATA_DIR "/makehuman").value(), {}).value();
  return body;
}

TEST(Stretchable, IsTheSameBodyWhereLengthsAreZero) {
  const BodyModel stretched = stretchable(human());
  std::vector<double> pose = standing_pose(human());
  pose[3] = 0.2;
  pose[20] = 0.4;
  const auto before = skin_vertices(human(), pose);
  ASSERT_GT(stretched.skeleton.num_dofs(), human().skeleton.num_dofs() + 7);
  pose.resize(static_cast<size_t>(stretched.skeleton.num_dofs()), 0.0);
  const auto after = skin_vertices(stretched, pose);
  for (size_t v = 0; v < before.size(); v += 97) EXPECT_LT((before[v] - after[v]).norm(), 1e-6);
}

TEST(Stretchable, ALengthMovesTheJointAlongItsBone) {
  const BodyModel stretched = stretchable(human());
  const int d = *stretched.skeleton.find_dof("right_shin_length");
  EXPECT_TRUE(stretched.skeleton.dofs()[static_cast<size_t>(d)].is_shape);
  std::vector<double> pose(static_cast<size_t>(stretched.skeleton.num_dofs()), 0.0);
  pose[static_cast<size_t>(*stretched.skeleton.find_dof("right_thigh_rx"))] = 0.7;
  const auto thigh = static_cast<size_t>(*stretched.skeleton.find_joint("right_thigh"));
  const auto shin = static_cast<size_t>(*stretched.skeleton.find_joint("right_shin"));
  const auto before = stretched.skeleton.forward_kinematics(pose);
  pose[static_cast<size_t>(d)] = 0.02;
  const auto after = stretched.skeleton.forward_kinematics(pose);
  EXPECT_NEAR((after[shin].translation - after[thigh].translation).norm() -
                  (before[shin].translation - before[thigh].translation).norm(),
              0.02, 1e-9);
}

TEST(StretchCovariance, IsPositiveAndTiesRightToLeft) {
  const Skeleton skeleton = stretchable(human()).skeleton;
  const Eigen::MatrixXd covariance = stretch_covariance(skeleton);
  const auto indices = shape_dofs(skeleton);
  ASSERT_EQ(covariance.rows(), std::ssize(indices));
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(covariance).eigenvalues().minCoeff(), 0);
  const auto at = [&](const char* name) {
    return std::ranges::find(indices, *skeleton.find_dof(name)) - indices.begin();
  };
  const auto r = at("right_shin_length"), l = at("left_shin_length"), a = at("right_forearm_length");
  const auto correlation = [&](auto i, auto j) {
    return covariance(i, j) / std::sqrt(covariance(i, i) * covariance(j, j));
  };
  EXPECT_GT(correlation(r, l), 0.95);
  EXPECT_LT(correlation(r, a), 0.5);
}

}  // namespace
}  // namespace silpose
