#include "silpose/body/rig_profile.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "silpose/body/default_profile.h"
#include "silpose/body/human_profile.h"
#include "silpose/body/rigs_for_test.h"
#include "silpose/body/stretchable.h"
#include "silpose/human/human_for_test.h"

namespace silpose {
namespace {

using testing::DoubleNear;
using testing::Each;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::SizeIs;

std::vector<std::string> names_of(const Skeleton& skeleton, std::span<const int> joints) {
  std::vector<std::string> names;
  for (const int j : joints) names.push_back(skeleton.joints()[static_cast<size_t>(j)].name);
  return names;
}

TEST(HumanProfile, HasHeadLegsAndArms) {
  const BodyModel& human = *human_for_test();
  const RigProfile& profile = human.profile;
  const Skeleton& skeleton = human.skeleton;
  EXPECT_NO_THROW(check_profile(profile, skeleton));
  EXPECT_THAT(profile.root_translations, ElementsAre(0, 1, 2));
  EXPECT_EQ(profile.heading, skeleton.find_dof("root_ry"));
  EXPECT_EQ(profile.up, Eigen::Vector3d(0, 1, 0));
  EXPECT_EQ(profile.facing, Eigen::Vector3d(0, 0, 1));
  ASSERT_THAT(profile.limbs, SizeIs(5));
  EXPECT_THAT(names_of(skeleton, profile.limbs[0].joints), ElementsAre("head"));
  EXPECT_THAT(names_of(skeleton, profile.limbs[1].joints),
              ElementsAre("right_hip", "right_thigh", "right_shin", "right_foot"));
  EXPECT_THAT(names_of(skeleton, profile.limbs[4].joints),
              ElementsAre("left_shoulder", "left_upper_arm", "left_forearm", "left_hand"));
  ASSERT_THAT(profile.limb_pairs, SizeIs(2));
  EXPECT_EQ(profile.limb_pairs[0].right, 1u);
  EXPECT_EQ(profile.limb_pairs[0].left, 2u);
  EXPECT_EQ(skeleton.joints()[static_cast<size_t>(profile.across[1].left)].name, "left_upper_arm");
  EXPECT_THAT(names_of(skeleton, profile.contact_joints), ElementsAre("right_foot", "left_foot"));
  EXPECT_THAT(profile.landmarks, SizeIs(13));
  EXPECT_EQ(profile.landmark_called("LKnee", "openpose"), "left_shin");
  EXPECT_EQ(profile.landmark_called("LKnee", "coco"), "");
  EXPECT_THAT(profile.poses, SizeIs(17));
  EXPECT_EQ(side_of(profile, skeleton, *skeleton.find_joint("left_hand")), BodySide::kLeft);
  EXPECT_EQ(side_of(profile, skeleton, *skeleton.find_joint("right_hip")), BodySide::kRight);
  EXPECT_EQ(side_of(profile, skeleton, *skeleton.find_joint("head")), BodySide::kMiddle);
}

// What default_profile() finds from tree and mesh alone is what the tables say.
TEST(HumanProfile, IsDerivedButForItsTables) {
  const BodyModel& human = *human_for_test();
  const RigProfile derived = default_profile(human);
  EXPECT_EQ(derived.root_translations, human.profile.root_translations);
  EXPECT_EQ(derived.heading, human.profile.heading);
  EXPECT_EQ(derived.contact_joints, human.profile.contact_joints);
  ASSERT_EQ(derived.limbs.size(), human.profile.limbs.size());
  for (size_t l = 0; l < derived.limbs.size(); ++l) EXPECT_EQ(derived.limbs[l].dofs, human.profile.limbs[l].dofs);
  EXPECT_NEAR(derived.silhouette_area, 0.149, 0.002);  // human_profile() takes 0.1
}

TEST(HumanProfile, PairsAreFoundWithoutNames) {
  const Skeleton& human = human_for_test()->skeleton;
  std::vector<Dof> dofs(human.dofs().begin(), human.dofs().end());
  for (size_t d = 0; d < dofs.size(); ++d) dofs[d].name = "dof" + std::to_string(d);
  const RigProfile profile =
      tree_profile(Skeleton("nameless", {human.joints().begin(), human.joints().end()}, std::move(dofs)));
  ASSERT_THAT(profile.limb_pairs, SizeIs(2));
  EXPECT_EQ(profile.limb_pairs[1].right, 3u);
  EXPECT_EQ(profile.limb_pairs[1].left, 4u);
}

TEST(HumanProfile, NoiseIsFromTheTable) {
  const Skeleton& skeleton = human_for_test()->skeleton;
  const RigProfile profile = human_profile(skeleton);
  const auto at = [&](const char* name) { return static_cast<size_t>(*skeleton.find_dof(name)); };
  EXPECT_EQ(profile.noise[at("root_tx")], 0.020);
  EXPECT_EQ(profile.noise[at("left_shin_rx")], to_radians(5));
  EXPECT_EQ(profile.acceleration[at("right_foot_rx")], to_radians(3));
  EXPECT_EQ(profile.rest[at("root_ry")], 0);
  EXPECT_EQ(profile.rest[at("left_thigh_rx")], to_radians(30));
  EXPECT_EQ(profile.rest_if_seen[at("left_thigh_rx")], to_radians(30) * 3);
  EXPECT_EQ(profile.rest_if_seen[at("left_thigh_rz")], profile.rest[at("left_thigh_rz")]);
  for (const Dof& dof : skeleton.dofs()) {
    if (!dof.name.starts_with("right_")) continue;
    EXPECT_EQ(profile.noise[at(dof.name.c_str())], profile.noise[at(("left_" + dof.name.substr(6)).c_str())]);
  }
}

TEST(Extended, LengthsJoinTheLimbsOfTheirBones) {
  const BodyModel body = stretchable(*human_for_test());
  EXPECT_NO_THROW(check_profile(body.profile, body.skeleton));
  const int shin = *body.skeleton.find_dof("right_shin_length"), thorax = *body.skeleton.find_dof("head_length");
  EXPECT_EQ(body.profile.limbs[1].dofs.back(), *body.skeleton.find_dof("right_foot_length"));
  EXPECT_THAT(body.profile.limbs[1].dofs, testing::Contains(shin));
  EXPECT_THAT(body.profile.limbs[0].dofs, testing::Contains(thorax));
  EXPECT_EQ(body.profile.noise[static_cast<size_t>(shin)], 0.010);  // along y
  EXPECT_EQ(body.profile.rest[static_cast<size_t>(shin)], 0);
  EXPECT_EQ(body.profile.noise[5], human_for_test()->profile.noise[5]);
}

TEST(TreeProfile, AChainWithAFixedRootIsALimbWithoutHeading) {
  const BodyModel body = make_chain_body();
  const RigProfile& profile = body.profile;
  EXPECT_NO_THROW(check_profile(profile, body.skeleton));
  EXPECT_THAT(profile.root_translations, IsEmpty());
  EXPECT_FALSE(profile.heading || profile.up || profile.facing);
  ASSERT_THAT(profile.limbs, SizeIs(1));
  EXPECT_THAT(profile.limbs[0].joints, ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(profile.limb_pairs, IsEmpty());
  EXPECT_THAT(profile.contact_joints, IsEmpty());
  EXPECT_EQ(profile.landmarks.back().name, "tip");
  // At rest and curled about x or z, either way; a quarter turn in all.
  ASSERT_THAT(profile.poses, SizeIs(5));
  EXPECT_THAT(profile.poses[0].pose, Each(0));
  EXPECT_EQ(profile.poses[1].name, "bent +x");
  EXPECT_NEAR(profile.poses[1].pose[0], to_radians(15), 1e-12);
  EXPECT_EQ(profile.poses[1].pose[1], 0);
  EXPECT_NEAR(profile.silhouette_area, 0.2 * 1.5 * (1 + std::sqrt(2)) / 2 / (1.5 * 1.5), 0.002);
}

TEST(TreeProfile, LongChainsAreSeveralLimbsAndFingersAreNone) {
  std::vector<Joint> joints = {{.name = "root", .dof_indices = {0}}};
  std::vector<Dof> dofs = {{.name = "root_rx", .lower = -1, .upper = 1}};
  const auto add = [&](int parent, const Eigen::Vector3d& offset) {
    const int j = static_cast<int>(joints.size());
    joints.push_back({.name = "j" + std::to_string(j),
                      .parent_idx = parent,
                      .offset_in_parent = offset,
                      .dof_indices = {static_cast<int>(dofs.size())}});
    dofs.push_back({.name = joints.back().name + "_rx", .joint_idx = j, .lower = -1, .upper = 1});
    return j;
  };
  int last = 0;
  for (int i = 0; i < 6; ++i) last = add(last, {0, 1, 0});
  add(last, {0.3, 0, 0});   // a finger
  add(last, {-0.2, 0, 0});  // another, shorter
  const RigProfile profile = tree_profile(Skeleton("snake", joints, dofs));
  ASSERT_THAT(profile.limbs, SizeIs(2));
  EXPECT_THAT(profile.limbs[0].joints, ElementsAre(1, 2, 3, 4));
  EXPECT_THAT(profile.limbs[1].joints, ElementsAre(5, 6, 7));
  EXPECT_THAT(profile.limbs[1].dofs, ElementsAre(5, 6, 7, 8));
  EXPECT_FALSE(profile.heading);
}

TEST(TreeProfile, ReadsAxesInTheWorldWhateverTheJointsOwn) {
  const BodyModel body = make_rotations_first_body(), tube = make_test_body();
  EXPECT_NO_THROW(check_profile(body.profile, body.skeleton));
  EXPECT_EQ(body.profile.heading, 0);
  EXPECT_EQ(*body.profile.up, Eigen::Vector3d(0, 0, 1));
  EXPECT_THAT(body.profile.root_translations, ElementsAre(5, 6, 7));
  EXPECT_EQ(rotations_first(tube.profile.noise), body.profile.noise);
  EXPECT_NEAR(body.profile.silhouette_area, tube.profile.silhouette_area, 1e-9);
}

// The two rigs are one body.
TEST(RigsForTest, RotationsFirstLooksLikeTheTestBody) {
  const BodyModel body = make_rotations_first_body(), tube = make_test_body();
  const std::vector<double> pose = {0.3, 0.6, -0.4, 0.5, 0.4, -0.3, 0.2, 0.6};
  const auto x = skin_vertices(tube, pose), y = skin_vertices(body, rotations_first(pose));
  for (size_t v = 0; v < x.size(); ++v) EXPECT_LT((x[v] - y[v]).norm(), 1e-5);
  EXPECT_LT(furthest_apart(landmark_positions(tube, pose), landmark_positions(body, rotations_first(pose))), 1e-12);
  EXPECT_EQ(standing_pose(body), rotations_first(standing_pose(tube)));
}

TEST(PlaceRoot, MovesItWhereverItsTranslationsAre) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
  const Skeleton skeleton(
      "rig",
      {{.name = "root", .offset_in_parent = {0.1, 0.2, 0.3}, .dof_indices = {1, 3, 4, 0}},
       {.name = "tip", .parent_idx = 0, .offset_in_parent = {0, 1, 0}, .dof_indices = {2, 5}}},
      {{.name = "root_ry", .axis = y, .lower = -1, .upper = 1},
       {.name = "root_tz", .is_translation = true, .axis = z, .lower = -1, .upper = 1},
       {.name = "tip_ty", .joint_idx = 1, .is_translation = true, .axis = y, .lower = -1, .upper = 1},
       {.name = "root_tx", .is_translation = true, .axis = x, .lower = -1, .upper = 1},
       {.name = "root_down", .is_translation = true, .axis = -y, .lower = -1, .upper = 1},
       {.name = "tip_rx", .joint_idx = 1, .axis = x, .lower = -1, .upper = 1}});
  std::vector<double> pose = {0.5, 9, 0.25, 9, 9, -0.75};
  const Eigen::Vector3d place(3, -4, 5);
  place_root(skeleton, tree_profile(skeleton), pose, place);
  EXPECT_THAT(pose,
              ElementsAre(0.5, DoubleNear(4.7, 1e-12), 0.25, DoubleNear(2.9, 1e-12), DoubleNear(4.2, 1e-12), -0.75));
  EXPECT_LT((skeleton.forward_kinematics(pose)[0].translation - place).norm(), 1e-12);
}

TEST(PlaceRoot, LeavesARootThatCannotMove) {
  const Skeleton skeleton("arm", {{.name = "root", .dof_indices = {0, 1}}},
                          {{.name = "root_ry", .axis = Eigen::Vector3d::UnitY(), .lower = -1, .upper = 1},
                           {.name = "root_rx", .axis = Eigen::Vector3d::UnitX(), .lower = -1, .upper = 1}});
  std::vector<double> pose = {0.5, -0.25};
  place_root(skeleton, tree_profile(skeleton), pose, {1, 2, 3});
  EXPECT_THAT(pose, ElementsAre(0.5, -0.25));
  EXPECT_THROW(place_root(skeleton, tree_profile(skeleton), std::span(pose).first(1), {1, 2, 3}),
               std::invalid_argument);
}

TEST(PlaceRoot, KeepsBoundsAndFollowsTheRootsOwnAxes) {
  const BodyModel body = make_rotations_first_body();
  std::vector<double> pose(8, 0.1);
  place_root(body.skeleton, body.profile, pose, {1, 9, -2});
  EXPECT_THAT(pose, ElementsAre(0.1, 0.1, 0.1, 0.1, 0.1, DoubleNear(-2, 1e-12), DoubleNear(1, 1e-12), 3));
}

TEST(CheckProfile, RefusesWhatDoesNotFit) {
  const BodyModel body = make_test_body();
  const auto refuses = [&](const auto& change) {
    RigProfile profile = body.profile;
    change(profile);
    EXPECT_THROW(check_profile(profile, body.skeleton), std::invalid_argument);
  };
  refuses([](RigProfile& p) { p.root_translations = {3}; });
  refuses([](RigProfile& p) { p.heading = 8; });
  refuses([](RigProfile& p) { p.heading = 0; });
  refuses([](RigProfile& p) { p.up = Eigen::Vector3d(0, 2, 0); });
  refuses([](RigProfile& p) { p.limbs.push_back(p.limbs.front()); });
  refuses([](RigProfile& p) { p.limb_pairs.push_back({0, 0}); });
  refuses([](RigProfile& p) { p.contact_joints = {3}; });
  refuses([](RigProfile& p) { p.noise.pop_back(); });
  refuses([](RigProfile& p) { p.rest[0] = std::nan(""); });
  refuses([](RigProfile& p) { p.poses[0].pose.clear(); });
  refuses([](RigProfile& p) { p.silhouette_area = -1; });
}

}  // namespace
}  // namespace silpose
