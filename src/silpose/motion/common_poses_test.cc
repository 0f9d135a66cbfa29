#include "silpose/motion/common_poses.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <stdexcept>

#include "silpose/body/human_profile.h"
#include "silpose/body/rigs_for_test.h"
#include "silpose/body/test_body.h"
#include "silpose/human/human.h"

namespace silpose {
namespace {

// A stick figure with arms and legs of plausible length; x is the subject's left.
Skeleton stick_figure() {
  const std::vector<Eigen::Vector3d> right_leg = {{-0.1, 0.9, 0}, {-0.1, 0.9, 0}, {-0.1, 0.5, 0}, {-0.1, 0.1, 0}};
  const std::vector<Eigen::Vector3d> right_arm = {{-0.05, 1.4, 0}, {-0.2, 1.4, 0}, {-0.2, 1.1, 0}, {-0.2, 0.85, 0}};
  std::vector<Eigen::Vector3d> centres = {{0, 1, 0}, {0, 1.1, 0}, {0, 1.25, 0}, {0, 1.5, 0}};
  const auto add = [&](const std::vector<Eigen::Vector3d>& limb, double side) {
    for (const Eigen::Vector3d& x : limb) centres.emplace_back(side * x.x(), x.y(), x.z());
  };
  add(right_leg, 1);
  add(right_leg, -1);
  add(right_arm, 1);
  add(right_arm, -1);
  return human_skeleton(centres);
}

class CommonPosesTest : public testing::Test {
 protected:
  // Joint centre, in the root's own frame with the root at 0, of the named pose facing +Z.
  Eigen::Vector3d joint(const std::string& pose_name, const std::string& joint_name) const {
    const auto row = std::find(poses_.names().begin(), poses_.names().end(), pose_name) - poses_.names().begin();
    const auto pose = poses_.poses().row(row);
    const std::vector<Rigid3> joints = skeleton_.forward_kinematics({pose.data(), static_cast<size_t>(pose.size())});
    return joints[static_cast<size_t>(*skeleton_.find_joint(joint_name))].translation;
  }
  Skeleton skeleton_ = stick_figure();
  CommonPoses poses_{skeleton_, human_profile(skeleton_)};
};

TEST_F(CommonPosesTest, FaceEightDirections) {
  const int heading = *skeleton_.find_dof("root_ry");
  EXPECT_GE(poses_.poses().rows(), 10 * 8);
  EXPECT_EQ(poses_.poses().rows() % 8, 0);
  EXPECT_EQ(poses_.names().size(), static_cast<size_t>(poses_.poses().rows()));
  std::set<long> degrees;
  for (Eigen::Index k = 0; k < 8; ++k) {
    EXPECT_EQ(poses_.names()[static_cast<size_t>(k)], "standing");
    degrees.insert(std::lround(to_degrees(poses_.poses()(k, heading))) % 360);
  }
  for (auto& name : {"standing", "t-pose", "a-pose", "right stride", "left stride", "hands on hips", "arms raised"}) {
    EXPECT_EQ(std::count(poses_.names().begin(), poses_.names().end(), name), 8) << name;
  }
  EXPECT_EQ(degrees.size(), 8u);
}

TEST_F(CommonPosesTest, AreWithinLimitsAndAtTheOrigin) {
  for (Eigen::Index k = 0; k < poses_.poses().rows(); ++k) {
    const auto row = poses_.poses().row(k);
    std::vector<double> pose(row.begin(), row.end());
    for (size_t d = 0; d < 3; ++d) EXPECT_EQ(pose[d], 0);
    std::vector<double> clamped = pose;
    skeleton_.clamp(clamped);
    for (size_t d = 0; d < pose.size(); ++d) EXPECT_NEAR(clamped[d], pose[d], 1e-12);
  }
}

TEST_F(CommonPosesTest, LookLikeTheirNames) {
  // T: hands as high as the shoulders, far out.
  EXPECT_NEAR(joint("t-pose", "right_hand").y(), joint("t-pose", "right_upper_arm").y(), 0.01);
  EXPECT_LT(joint("t-pose", "right_hand").x(), -0.7);
  EXPECT_GT(joint("t-pose", "left_hand").x(), 0.7);
  // Strides: one foot before, one behind, the opposite arm before.
  EXPECT_GT(joint("right stride", "right_foot").z(), 0.2);
  EXPECT_LT(joint("right stride", "left_foot").z(), -0.2);
  EXPECT_GT(joint("right stride", "left_hand").z(), joint("right stride", "right_hand").z() + 0.2);
  EXPECT_GT(joint("left stride", "left_foot").z(), joint("left stride", "right_foot").z() + 0.4);
  EXPECT_GT(joint("right leg passing", "right_foot").y(), joint("right leg passing", "left_foot").y() + 0.1);
  // Raised arms end above the head's joint.
  EXPECT_GT(joint("arms raised", "left_hand").y(), joint("arms raised", "head").y() + 0.3);
  EXPECT_GT(joint("right arm raised", "right_hand").y(), 0.5);
  EXPECT_LT(joint("right arm raised", "left_hand").y(), 0.2);
  EXPECT_GT(joint("arms forward", "right_hand").z(), 0.4);
  // Hands on hips: hands nearer to the middle than the elbows, at the height of the waist, not before the belly.
  EXPECT_LT(joint("hands on hips", "right_forearm").x(), joint("hands on hips", "right_hand").x() - 0.1);
  EXPECT_LT(std::abs(joint("hands on hips", "right_hand").y()), 0.25);
  EXPECT_LT(std::abs(joint("hands on hips", "right_hand").z()), 0.2);
  // Sitting and crouching bring the feet nearer to the pelvis.
  EXPECT_GT(joint("crouch", "right_foot").y(), joint("standing", "right_foot").y() + 0.15);
  EXPECT_GT(joint("sitting", "right_shin").z(), 0.35);
  EXPECT_LT(joint("sitting", "right_foot").y(), joint("sitting", "right_shin").y() - 0.35);
  EXPECT_GT(joint("bent forward", "head").z(), 0.2);
}

TEST_F(CommonPosesTest, ProposesAllOrAChoiceWithoutRepetition) {
  Rng rng(1), again(1);
  const StateBatch all = poses_.propose({}, 0, rng).poses;
  EXPECT_EQ(all.rows(), poses_.poses().rows());
  EXPECT_EQ(poses_.propose({}, 100000, rng).poses.rows(), all.rows());
  (void)poses_.propose({}, 0, again);
  const StateBatch some = poses_.propose({}, 20, rng).poses;
  EXPECT_TRUE((some.array() == poses_.propose({}, 20, again).poses.array()).all());
  std::set<Eigen::Index> chosen;
  for (Eigen::Index i = 0; i < 20; ++i) {
    for (Eigen::Index k = 0; k < all.rows(); ++k) {
      if ((all.row(k).array() == some.row(i).array()).all()) chosen.insert(k);
    }
  }
  EXPECT_EQ(chosen.size(), 20u);
  EXPECT_THROW((void)poses_.propose({}, -1, rng), std::invalid_argument);
}

TEST(CommonPoses, OfAnotherRigAreItsProfilesAtEachHeading) {
  const BodyModel tube = make_test_body(), chain = make_chain_body();
  const CommonPoses poses(tube.skeleton, tube.profile), fixed(chain.skeleton, chain.profile);
  EXPECT_EQ(poses.poses().rows(), static_cast<Eigen::Index>(8 * tube.profile.poses.size()));
  EXPECT_EQ(poses.poses().cols(), 8);
  EXPECT_EQ(poses.names().front(), "rest");
  EXPECT_EQ(fixed.poses().rows(), static_cast<Eigen::Index>(chain.profile.poses.size()));
  EXPECT_THROW(CommonPoses(tube.skeleton, RigProfile{}), std::invalid_argument);
  EXPECT_THROW(CommonPoses(human_skeleton(std::vector<Eigen::Vector3d>(20, Eigen::Vector3d::Zero())), tube.profile),
               std::invalid_argument);
}

}  // namespace
}  // namespace silpose
