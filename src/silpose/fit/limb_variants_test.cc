#include "silpose/fit/limb_variants.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "silpose/body/human_profile.h"
#include "silpose/body/rigs_for_test.h"
#include "silpose/body/test_body.h"
#include "silpose/human/human_for_test.h"

namespace silpose {
namespace {

using ::testing::SizeIs;

// The angles of alike limbs change places; all others stay.
TEST(Exchange, SwapsTheAnglesOfTwoLimbs) {
  const Skeleton skeleton = human_skeleton(std::vector<Eigen::Vector3d>(20, Eigen::Vector3d::Zero()));
  const RigProfile profile = human_profile(skeleton);
  ASSERT_THAT(profile.limb_pairs, SizeIs(2));
  std::vector<double> pose(37, 0.0);
  const auto at = [&](const char* name) { return static_cast<size_t>(*skeleton.find_dof(name)); };
  pose[at("right_thigh_rx")] = 0.5;
  pose[at("left_hand_rz")] = 0.2;
  pose[at("thorax_ry")] = 0.1;
  std::vector<double> legs = pose, arms = pose;
  exchange(legs, profile.limbs[profile.limb_pairs[0].right], profile.limbs[profile.limb_pairs[0].left]);
  exchange(arms, profile.limbs[profile.limb_pairs[1].right], profile.limbs[profile.limb_pairs[1].left]);
  EXPECT_EQ(legs[at("left_thigh_rx")], 0.5);
  EXPECT_EQ(legs[at("right_thigh_rx")], 0);
  EXPECT_EQ(legs[at("left_hand_rz")], 0.2);
  EXPECT_EQ(arms[at("right_hand_rz")], 0.2);
  EXPECT_EQ(arms[at("right_thigh_rx")], 0.5);
  for (const auto& variant : {legs, arms}) EXPECT_EQ(variant[at("thorax_ry")], 0.1);
}

const BodyModel& human() { return *human_for_test(); }

std::vector<double> walking_pose() {
  const BodyModel& body = human();
  std::vector<double> pose = standing_pose(body);
  const auto set = [&](const char* name, double degrees) {
    pose[static_cast<size_t>(*body.skeleton.find_dof(name))] = to_radians(degrees);
  };
  set("root_ry", 30);
  set("root_rz", 4);
  set("thorax_ry", 10);
  set("right_thigh_rx", 30);
  set("right_shin_rx", 15);
  set("left_shin_rx", 40);
  set("left_upper_arm_rz", 25);
  set("left_upper_arm_rx", 20);
  set("left_forearm_rx", 35);
  return pose;
}

TEST(ReflectedLimb, KeepsWhereTheJointsAreSeenFromAfar) {
  const BodyModel& body = human();
  const std::vector<double> pose = walking_pose();
  const Eigen::Vector3d camera_centre(0, 1, 200);  // far: perspective is negligible
  const auto before = landmark_positions(body, pose);
  int found = 0;
  for (const Limb& limb : body.profile.limbs) {
    for (const auto& variant : reflected_limb(body, limb, pose, camera_centre)) {
      ++found;
      const auto after = landmark_positions(body, variant);
      double in_image = 0, in_depth = 0;
      for (size_t i = 0; i < after.size(); ++i) {
        in_image = std::max(in_image, (after[i] - before[i]).head<2>().norm());
        in_depth = std::max(in_depth, std::abs(after[i].z() - before[i].z()));
      }
      EXPECT_LT(in_image, 0.06);
      EXPECT_GT(in_depth, 0.03);
      for (size_t d = 0; d < pose.size(); ++d) {
        const bool own = std::ranges::find(limb.dofs, static_cast<int>(d)) != limb.dofs.end();
        EXPECT_TRUE(own || std::abs(variant[d] - pose[d]) < 1e-12);
      }
    }
  }
  EXPECT_GE(found, 3);
}

TEST(MirroredInDepth, IsTheReflectionOfEveryJointWithItsPartner) {
  const BodyModel& body = human();
  const std::vector<double> pose = walking_pose();
  const Eigen::Vector3d camera_centre(2, 1, 5), root(pose[0], pose[1], pose[2]);
  const std::vector<double> mirrored = mirrored_in_depth(body, pose, camera_centre);
  Eigen::Vector3d normal = camera_centre - root;
  normal.y() = 0;
  normal.normalize();
  const auto names = landmark_names(body);
  const auto before = landmark_positions(body, pose), after = landmark_positions(body, mirrored);
  for (size_t i = 0; i < names.size(); ++i) {
    std::string partner = names[i];
    if (partner.starts_with("right_"))
      partner = "left_" + partner.substr(6);
    else if (partner.starts_with("left_"))
      partner = "right_" + partner.substr(5);
    const auto j = static_cast<size_t>(std::ranges::find(names, partner) - names.begin());
    const Eigen::Vector3d expected = before[i] - 2 * normal.dot(before[i] - root) * normal;
    EXPECT_LT((after[j] - expected).norm(), 0.015) << names[i];  // the mesh is not quite symmetric
  }
}

// A rig whose own axes are not the world's: the same body, mirrored in the same way.
TEST(MirroredInDepth, FollowsTheRigsOwnAxes) {
  const BodyModel tube = make_test_body();
  BodyModel turned = make_rotations_first_body();
  const Eigen::Vector3d camera_centre(2, 1, 5);
  const std::vector<double> pose = {0.3, 0.6, -0.4, 0.5, 0.4, -0.3, 0.2, 0.6};
  EXPECT_TRUE(
      mirrored_in_depth(turned, rotations_first(pose), camera_centre).empty());  // it is not known where it faces
  turned.profile.facing = Eigen::Vector3d(0, -1, 0);
  EXPECT_LT(furthest_apart(landmark_positions(turned, mirrored_in_depth(turned, rotations_first(pose), camera_centre)),
                           landmark_positions(tube, mirrored_in_depth(tube, pose, camera_centre))),
            1e-12);
}

TEST(RandomLimb, MovesOnlyTheLimbAndStaysInside) {
  const Skeleton& skeleton = human().skeleton;
  const std::vector<double> pose = walking_pose();
  Rng rng(3);
  for (const Limb& limb : human().profile.limbs) {
    const auto variant = random_limb(skeleton, limb, pose, rng);
    EXPECT_NE(variant, pose);
    for (size_t d = 0; d < pose.size(); ++d) {
      const bool own = std::ranges::find(limb.dofs, static_cast<int>(d)) != limb.dofs.end();
      const bool inside = variant[d] >= skeleton.dofs()[d].lower && variant[d] <= skeleton.dofs()[d].upper;
      EXPECT_TRUE(own ? inside : variant[d] == pose[d]) << d;
    }
  }
}

TEST(LimbVariants, MoveOneLimbOrTwoAndNothingElse) {
  const BodyModel& body = human();
  const std::vector<Limb>& limbs = body.profile.limbs;
  const std::vector<double> pose = walking_pose();
  const Eigen::Vector3d camera_centre(2, 1, 5);
  const auto with = [&](int num_random, double two_at_once) {
    Rng rng(5);
    return limb_variants(body, limbs, pose, camera_centre, num_random, two_at_once, rng);
  };
  const auto given = with(0, 0);  // reflections and exchanges come first
  for (const double two_at_once : {0.0, 0.5, 1.0}) {
    const auto variants = with(40, two_at_once);
    ASSERT_EQ(variants.size(), given.size() + 40);
    int64_t pairs = 0;
    for (size_t v = given.size(); v < variants.size(); ++v) {
      pairs += std::ssize(variants[v].limbs) - 1;
      for (size_t d = 0; d < pose.size(); ++d) {
        const bool own = std::ranges::any_of(variants[v].limbs, [&](size_t l) {
          return std::ranges::find(limbs[l].dofs, static_cast<int>(d)) != limbs[l].dofs.end();
        });
        EXPECT_TRUE(own || variants[v].pose[d] == pose[d]) << v << " " << d;
      }
    }
    EXPECT_NEAR(static_cast<double>(pairs), 40 * two_at_once, two_at_once == 0.5 ? 12 : 0);
  }
}

}  // namespace
}  // namespace silpose
