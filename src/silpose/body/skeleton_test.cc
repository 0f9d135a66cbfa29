#include "silpose/body/skeleton.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "silpose/base/rng.h"
#include "silpose/body/human_profile.h"
#include "silpose/human/human.h"

namespace silpose {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;

// A person 1.75 m tall, in round numbers, in the zero pose.
std::vector<Eigen::Vector3d> round_joints() {
  return {{0, 1, 0},     {0, 1.1, 0},   {0, 1.25, 0},  {0, 1.5, 0},  {-.1, .9, 0}, {-.1, .9, 0},   {-.1, .5, 0},
          {-.1, .1, 0},  {.1, .9, 0},   {.1, .9, 0},   {.1, .5, 0},  {.1, .1, 0},  {-.05, 1.4, 0}, {-.2, 1.4, 0},
          {-.2, 1.1, 0}, {-.2, .85, 0}, {.05, 1.4, 0}, {.2, 1.4, 0}, {.2, 1.1, 0}, {.2, .85, 0}};
}

class HumanSkeleton : public testing::Test {
 protected:
  const Skeleton skeleton = human_skeleton(round_joints());
  std::vector<double> pose = std::vector<double>(37, 0.0);

  void SetUp() override {
    EXPECT_TRUE(has_human_joints(skeleton));
    pose[1] = 1;
  }
  void turn(const std::string& dof, double degrees) { pose.at(skeleton.find_dof(dof).value()) = to_radians(degrees); }
  Eigen::Vector3d joint(const std::string& name) {
    return skeleton.forward_kinematics(pose).at(skeleton.find_joint(name).value()).translation;
  }
  // Where a world direction of the zero pose, fixed to a joint, points now.
  Eigen::Vector3d direction(const std::string& name, const Eigen::Vector3d& zero_direction) {
    return skeleton.forward_kinematics(pose).at(skeleton.find_joint(name).value()).rotation * zero_direction;
  }
  static void expect_near(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    EXPECT_LT((a - b).norm(), 1e-12) << a.transpose() << " is not " << b.transpose();
  }
};

TEST_F(HumanSkeleton, HasTheColumnsInOrder) {
  std::vector<std::string> columns;
  for (const Dof& dof : skeleton.dofs()) columns.push_back(dof.column());
  EXPECT_THAT(
      columns,
      ElementsAre("root_tx_m", "root_ty_m", "root_tz_m", "root_rx_deg", "root_ry_deg", "root_rz_deg", "abdomen_rx_deg",
                  "thorax_rx_deg", "thorax_ry_deg", "thorax_rz_deg", "head_rx_deg", "head_ry_deg", "head_rz_deg",
                  "right_thigh_rx_deg", "right_thigh_ry_deg", "right_thigh_rz_deg", "right_shin_rx_deg",
                  "right_foot_rx_deg", "left_thigh_rx_deg", "left_thigh_ry_deg", "left_thigh_rz_deg",
                  "left_shin_rx_deg", "left_foot_rx_deg", "right_upper_arm_rx_deg", "right_upper_arm_ry_deg",
                  "right_upper_arm_rz_deg", "right_forearm_rx_deg", "right_forearm_ry_deg", "right_hand_rx_deg",
                  "right_hand_rz_deg", "left_upper_arm_rx_deg", "left_upper_arm_ry_deg", "left_upper_arm_rz_deg",
                  "left_forearm_rx_deg", "left_forearm_ry_deg", "left_hand_rx_deg", "left_hand_rz_deg"));
}

TEST_F(HumanSkeleton, HasTheJointsOfTheThesis) {
  std::vector<std::string> names;
  for (const Joint& j : skeleton.joints()) names.push_back(j.name);
  EXPECT_THAT(names, ElementsAre("root", "abdomen", "thorax", "head", "right_hip", "right_thigh", "right_shin",
                                 "right_foot", "left_hip", "left_thigh", "left_shin", "left_foot", "right_shoulder",
                                 "right_upper_arm", "right_forearm", "right_hand", "left_shoulder", "left_upper_arm",
                                 "left_forearm", "left_hand"));
}

TEST_F(HumanSkeleton, ZeroPoseHasTheGivenJoints) {
  const std::vector<Rigid3> world_from_joint = skeleton.forward_kinematics(pose);
  for (size_t j = 0; j < 20; ++j) expect_near(world_from_joint[j].translation, round_joints()[j]);
}

TEST_F(HumanSkeleton, PositiveXIsFlexion) {
  turn("right_thigh_rx", 90);  // thigh forward
  expect_near(joint("right_shin"), {-.1, .9, .4});
  turn("right_shin_rx", 90);  // shin back, so down again
  expect_near(joint("right_foot"), {-.1, .5, .4});
  turn("left_upper_arm_rx", 90);  // arm forward
  expect_near(joint("left_forearm"), {.2, 1.4, .3});
  turn("left_forearm_rx", 90);  // forearm up
  expect_near(joint("left_hand"), {.2, 1.65, .3});
  turn("thorax_rx", 90);  // bow: what was up is forward
  expect_near(joint("head"), {0, 1.25, .25});
}

TEST_F(HumanSkeleton, FeetAndHandsFlexTheRightWay) {
  turn("left_foot_rx", 90);  // dorsiflexion: toes up
  expect_near(direction("left_foot", {0, 0, 1}), {0, 1, 0});
  turn("right_hand_rx", 90);  // palmar flexion: fingers, which hang, go to the middle
  turn("left_hand_rx", 90);
  expect_near(direction("right_hand", {0, -1, 0}), {1, 0, 0});
  expect_near(direction("left_hand", {0, -1, 0}), {-1, 0, 0});
  turn("right_hand_rx", 0);
  turn("right_hand_rz", 90);  // radial: to the thumb, which is in front
  expect_near(direction("right_hand", {0, -1, 0}), {0, 0, 1});
}

TEST_F(HumanSkeleton, PositiveZIsAbductionAndPositiveYInward) {
  turn("right_thigh_rz", 90);
  turn("left_upper_arm_rz", 90);
  expect_near(joint("right_shin"), {-.5, .9, 0});
  expect_near(joint("left_forearm"), {.5, 1.4, 0});
  turn("left_thigh_ry", 90);  // toes to the middle
  turn("right_forearm_ry", 90);
  expect_near(direction("left_foot", {0, 0, 1}), {-1, 0, 0});
  expect_near(direction("right_hand", {0, 0, 1}), {1, 0, 0});
}

TEST_F(HumanSkeleton, ArmsReachOverheadBothWays) {
  turn("right_upper_arm_rx", 180);
  turn("left_upper_arm_rz", 180);
  expect_near(joint("right_forearm"), {-.2, 1.7, 0});
  expect_near(joint("left_forearm"), {.2, 1.7, 0});
  std::vector<double> clamped = pose;
  skeleton.clamp(clamped);
  EXPECT_EQ(clamped, pose);
}

TEST_F(HumanSkeleton, RootTurnsHeadingOutermost) {
  pose[0] = 2;
  pose[2] = -3;
  turn("root_ry", 90);  // faces +X
  turn("root_rx", 30);  // and tips the way it faces
  expect_near(joint("root"), {2, 1, -3});
  expect_near(direction("root", {0, 1, 0}), {.5, std::sqrt(.75), 0});
  turn("root_rx", 0);
  turn("root_rz", 30);  // leans to its own right: facing +X, that is +Z
  expect_near(direction("root", {0, 1, 0}), {0, std::sqrt(.75), .5});
}

TEST_F(HumanSkeleton, EqualAnglesAreMirrorImages) {
  Rng rng(7);
  for (size_t d = 13; d < 37; ++d) pose[d] = rng.uniform(-1, 1);
  for (size_t i = 0; i < 5; ++i) pose[18 + i] = pose[13 + i];
  for (size_t i = 0; i < 7; ++i) pose[30 + i] = pose[23 + i];
  const std::vector<Rigid3> frames = skeleton.forward_kinematics(pose);
  const Eigen::Vector3d mirror(-1, 1, 1);
  for (const int right : {4, 5, 6, 7, 12, 13, 14, 15}) {
    const int left = right + 4;
    expect_near(frames[left].translation, mirror.cwiseProduct(frames[right].translation));
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d axis = Eigen::Vector3d::Unit(k);
      expect_near(frames[left].rotation * mirror.cwiseProduct(axis),
                  mirror.cwiseProduct(frames[right].rotation * axis));
    }
  }
}

TEST_F(HumanSkeleton, ClampsAnglesWrapsTheRootAndLeavesPlaces) {
  pose[0] = 50;
  turn("root_ry", 200);
  turn("right_shin_rx", -40);
  turn("left_forearm_rx", 170);
  skeleton.clamp(pose);
  EXPECT_EQ(pose[0], 50);
  EXPECT_NEAR(pose[*skeleton.find_dof("root_ry")], to_radians(-160), 1e-12);
  EXPECT_NEAR(pose[*skeleton.find_dof("right_shin_rx")], to_radians(-10), 1e-12);
  EXPECT_NEAR(pose[*skeleton.find_dof("left_forearm_rx")], to_radians(150), 1e-12);
}

TEST_F(HumanSkeleton, NormalisesByTheLimits) {
  turn("right_shin_rx", 70);  // the middle of -10 to 150
  const std::vector<double> npsu = skeleton.normalise(pose);
  EXPECT_NEAR(npsu[*skeleton.find_dof("right_shin_rx")], 0.5, 1e-12);
  EXPECT_NEAR(npsu[0], 0.5, 1e-12);
  EXPECT_NEAR(npsu[1], 1.0 / 3, 1e-12);
  EXPECT_THAT(skeleton.denormalise(npsu), testing::Pointwise(DoubleNear(1e-12), pose));
}

TEST_F(HumanSkeleton, FindsByNameAndColumn) {
  EXPECT_EQ(skeleton.find_dof("left_hand_rz"), 36);
  EXPECT_EQ(skeleton.find_dof("left_hand_rz_deg"), 36);
  EXPECT_EQ(skeleton.find_dof("tail_rx"), std::nullopt);
  EXPECT_EQ(skeleton.find_joint("left_hand"), 19);
  EXPECT_TRUE(skeleton.is_below(15, 2));
  EXPECT_TRUE(skeleton.is_below(2, 2));
  EXPECT_FALSE(skeleton.is_below(5, 2));
}

TEST(Skeleton, TurnsAboutAnyAxis) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1, 2, 2) / 3;
  const Skeleton skeleton("one", {{.name = "root", .dof_indices = {0}}},
                          {{.name = "root_r", .axis = axis, .lower = -1, .upper = 1}});
  const std::vector<double> pose = {0.7};
  EXPECT_TRUE(
      skeleton.forward_kinematics(pose)[0].rotation.isApprox(Eigen::AngleAxisd(0.7, axis).toRotationMatrix(), 1e-12));
}

// A root with an offset whose rotations come first, whose translations are in another order than x, y, z, and one of
// which points down.
// A joint whose own axes are turned at rest: its DOF turn about them, and the joints below go along.
TEST(Skeleton, KeepsRestRotations) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), z = Eigen::Vector3d::UnitZ();
  const Eigen::Matrix3d quarter = Eigen::AngleAxisd(kPi / 2, z).toRotationMatrix();  // own x is the parent's y
  const Skeleton skeleton(
      "arm",
      {{.name = "root", .dof_indices = {0}},
       {.name = "elbow", .parent_idx = 0, .offset_in_parent = x, .dof_indices = {1, 2}, .parent_from_rest = quarter},
       {.name = "hand", .parent_idx = 1, .offset_in_parent = x}},
      {{.name = "root_rz", .axis = z, .lower = -4, .upper = 4},
       {.name = "elbow_tx", .joint_idx = 1, .is_translation = true, .axis = x, .lower = -1, .upper = 1},
       {.name = "elbow_rz", .joint_idx = 1, .axis = z, .lower = -4, .upper = 4}});
  EXPECT_LT((skeleton.axis_in_parent(1) - Eigen::Vector3d::UnitY()).norm(), 1e-12);
  const auto hand = [&](const std::vector<double>& pose) -> Eigen::Vector3d {
    return skeleton.forward_kinematics(pose)[2].translation;
  };
  EXPECT_LT((hand({0, 0, 0}) - Eigen::Vector3d(1, 1, 0)).norm(), 1e-12);
  EXPECT_LT((hand({0, 0.5, 0}) - Eigen::Vector3d(1, 1.5, 0)).norm(), 1e-12);
  EXPECT_LT((hand({0, 0, kPi / 2}) - Eigen::Vector3d(0, 0, 0)).norm(), 1e-12);
  EXPECT_LT((hand({kPi / 2, 0, 0}) - Eigen::Vector3d(-1, 1, 0)).norm(), 1e-12);
  const std::vector<double> pose = {0.3, 0.2, -0.7};
  const std::vector<Rigid3> at = skeleton.forward_kinematics(pose);
  const Eigen::Matrix3Xd axes = skeleton.dof_axes(pose, at);
  for (size_t d = 0; d < 3; ++d) {
    std::vector<double> moved = pose;
    moved[d] += 1e-6;
    const Eigen::Vector3d centre = at[d == 0 ? 0 : 1].translation, axis = axes.col(static_cast<Eigen::Index>(d));
    const Eigen::Vector3d expected = d == 1 ? axis : Eigen::Vector3d(axis.cross(at[2].translation - centre));
    EXPECT_LT(((hand(moved) - at[2].translation) / 1e-6 - expected).norm(), 1e-5) << d;
  }
}

TEST(Skeleton, ClampsTranslationsThatAreBounded) {
  const Dof slide{.name = "slide", .is_translation = true, .lower = -0.1, .upper = 0.2};
  Dof bounded = slide;
  bounded.name = "rail";
  bounded.is_bounded = true;
  const Skeleton skeleton("s", {{.name = "root", .dof_indices = {0, 1}}}, {slide, bounded});
  std::vector<double> pose = {5, 5};
  skeleton.clamp(pose);
  EXPECT_THAT(pose, ElementsAre(5, 0.2));
  EXPECT_FALSE(skeleton.dofs()[0].has_limits());
  EXPECT_TRUE(skeleton.dofs()[1].has_limits());
}

TEST(Skeleton, RefusesWhatDoesNotFit) {
  const Dof dof{.name = "a_rx", .lower = -1, .upper = 1};
  EXPECT_THROW(Skeleton("s", {{.name = "a", .parent_idx = 0}}, {}), std::invalid_argument);
  EXPECT_THROW(Skeleton("s", {{.name = "a"}}, {dof}), std::invalid_argument);
  EXPECT_THROW(Skeleton("s", {{.name = "a", .dof_indices = {1}}}, {dof}), std::invalid_argument);
  Dof bad = dof;
  bad.upper = -2;
  EXPECT_THROW(Skeleton("s", {{.name = "a", .dof_indices = {0}}}, {bad}), std::invalid_argument);
  bad = dof;
  bad.axis *= 2;
  EXPECT_THROW(Skeleton("s", {{.name = "a", .dof_indices = {0}}}, {bad}), std::invalid_argument);
  EXPECT_THROW(Skeleton("s", {{.name = "a", .parent_from_rest = 2 * Eigen::Matrix3d::Identity()}}, {}),
               std::invalid_argument);
  EXPECT_THROW(Skeleton("s", {{.name = "a", .parent_from_rest = -Eigen::Matrix3d::Identity()}}, {}),
               std::invalid_argument);
  const Skeleton good("s", {{.name = "a", .dof_indices = {0}}}, {dof});
  EXPECT_THROW((void)good.forward_kinematics(std::vector<double>{1, 2}), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
