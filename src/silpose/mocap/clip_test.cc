#include "silpose/mocap/clip.h"

#include <gtest/gtest.h>

namespace silpose {
namespace {

using Eigen::Vector3d;

// A root 2 above the floor, a bone of 3 along x, an end 1 further; frame 1 turns the root by 90 degrees about z.
Clip two_bones() {
  const Eigen::Quaterniond none = Eigen::Quaterniond::Identity();
  const Eigen::Quaterniond quarter(Eigen::AngleAxisd(kPi / 2, Vector3d::UnitZ()));
  Clip clip;
  clip.joints = {{"root", -1, Vector3d::Zero(), false}, {"arm", 0, {3, 0, 0}, false}, {"arm_end", 1, {1, 0, 0}, true}};
  clip.rotations = {none, none, none, quarter, quarter, none};
  clip.translations = {{0, 2, 0}, {3, 0, 0}, {1, 0, 0}, {0, 2, 5}, {3, 0, 0}, {1, 0, 0}};
  return clip;
}

TEST(Clip, PlacesJointsByHand) {
  const Clip clip = two_bones();
  ASSERT_EQ(clip.num_frames(), 2U);
  EXPECT_TRUE(clip.forward_kinematics(0)[2].isApprox(Vector3d(4, 2, 0)));
  const auto turned = clip.forward_kinematics(1);
  EXPECT_TRUE(turned[0].isApprox(Vector3d(0, 2, 5)));
  EXPECT_TRUE(turned[1].isApprox(Vector3d(0, 5, 5)));
  EXPECT_TRUE(turned[2].isApprox(Vector3d(-1, 5, 5)));  // two quarter turns
  EXPECT_TRUE(clip.rest_positions()[2].isApprox(Vector3d(4, 0, 0)));
}

TEST(Clip, FindsJointsByName) {
  const Clip clip = two_bones();
  EXPECT_EQ(clip.find_joint("arm"), 1);
  EXPECT_FALSE(clip.find_joint("leg").has_value());
  EXPECT_EQ(clip.joint_names().back(), "arm_end");
}

TEST(Clip, RefusesFramesAndShapesThatDoNotFit) {
  Clip clip = two_bones();
  EXPECT_THROW((void)clip.forward_kinematics(2), std::invalid_argument);
  clip.translations.pop_back();
  EXPECT_THROW((void)clip.forward_kinematics(0), std::invalid_argument);
  clip = two_bones();
  clip.joints[1].parent_idx = 1;
  EXPECT_THROW((void)clip.forward_kinematics(0), std::invalid_argument);
  EXPECT_THROW((void)clip.rest_positions(), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
