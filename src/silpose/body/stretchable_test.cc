#include "silpose/body/stretchable.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "silpose/human/human_for_test.h"

namespace silpose {
namespace {

const BodyModel& human() { return *human_for_test(); }

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

TEST(WithLengths, IsTheStretchedBodyMadeAnOrdinaryOne) {
  const BodyModel stretched = stretchable(human());
  const std::vector<int> shape = shape_dofs(stretched.skeleton);
  std::vector<double> lengths(shape.size());
  for (size_t s = 0; s < lengths.size(); ++s) lengths[s] = 0.01 * (static_cast<double>(s % 3) - 1.2);
  const BodyModel body = with_lengths(human(), lengths);
  std::vector<double> pose(human().skeleton.dofs().size(), 0.0);
  for (size_t d = 6; d < pose.size(); ++d) pose[d] = 0.05 * static_cast<double>(d % 5);
  human().skeleton.clamp(pose);
  std::vector<double> long_pose = pose;
  long_pose.insert(long_pose.end(), lengths.begin(), lengths.end());
  const auto joints = landmark_positions(body, pose), same_joints = landmark_positions(stretched, long_pose);
  for (size_t l = 0; l < joints.size(); ++l) EXPECT_LT((joints[l] - same_joints[l]).norm(), 1e-9) << l;
  const auto skin = skin_vertices(body, pose), same_skin = skin_vertices(stretched, long_pose);
  for (size_t v = 0; v < skin.size(); v += 53) EXPECT_LT((skin[v] - same_skin[v]).norm(), 0.003) << v;

  std::vector<double> none(shape.size(), 0.0);
  EXPECT_NEAR(with_lengths(human(), none).height_m, human().height_m, 1e-6);
  none[static_cast<size_t>(std::ranges::find(shape, *stretched.skeleton.find_dof("right_shin_length")) -
                           shape.begin())] = -1;
  EXPECT_THROW((void)with_lengths(human(), none), std::invalid_argument);
  EXPECT_THROW((void)with_lengths(human(), {}), std::invalid_argument);
}

TEST(WithLengths, LongerShinsMakeATallerBodyThatStandsOnTheFloor) {
  const BodyModel stretched = stretchable(human());
  const std::vector<int> shape = shape_dofs(stretched.skeleton);
  std::vector<double> lengths(shape.size(), 0.0);
  for (size_t s = 0; s < shape.size(); ++s) {
    if (stretched.skeleton.dofs()[static_cast<size_t>(shape[s])].name.ends_with("_shin_length")) lengths[s] = 0.03;
  }
  const BodyModel body = with_lengths(human(), lengths);
  EXPECT_NEAR(body.height_m, human().height_m + 0.03, 0.002);
  float lowest = 1;
  for (const Eigen::Vector3f& x : body.rest.vertices) lowest = std::min(lowest, x.y());
  EXPECT_NEAR(lowest, 0, 1e-6);
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

TEST(Scaled, EveryPointIsFurtherFromTheRootByTheFactor) {
  const BodyModel larger = scaled(human(), 1.1);
  std::vector<double> pose(human().skeleton.dofs().size(), 0.0);
  pose[6] = 0.3, pose[20] = 0.5;
  const auto before = skin_vertices(human(), pose), after = skin_vertices(larger, pose);
  for (size_t v = 0; v < before.size(); v += 97) EXPECT_LT((after[v] - 1.1f * before[v]).norm(), 1e-5);
  const auto joints = landmark_positions(human(), pose), larger_joints = landmark_positions(larger, pose);
  for (size_t l = 0; l < joints.size(); ++l) EXPECT_LT((larger_joints[l] - 1.1 * joints[l]).norm(), 1e-9);
  EXPECT_NEAR(larger.height_m, 1.1 * human().height_m, 1e-9);
  EXPECT_THROW((void)scaled(human(), 0), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
