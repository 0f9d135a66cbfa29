#include "silpose/fit/depth_ambiguity_moves.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <string>

#include "silpose/body/test_body.h"
#include "silpose/human/human_for_test.h"

namespace silpose {
namespace {

const BodyModel& human() { return *human_for_test(); }

// Arms that differ, seen from 45 degrees.
std::vector<double> reaching_pose() {
  std::vector<double> pose = standing_pose(human());
  const auto set = [&](const char* name, double degrees) {
    pose[static_cast<size_t>(*human().skeleton.find_dof(name))] = to_radians(degrees);
  };
  set("right_upper_arm_rx", 70);
  set("right_forearm_rx", 20);
  set("left_upper_arm_rz", 30);
  set("left_forearm_rx", 30);
  return pose;
}

const Eigen::Vector3d kEye(4, 1, 4);

Eigen::Vector3d place_of(const std::string& name, const std::vector<double>& pose) {
  const auto names = landmark_names(human());
  return landmark_positions(human(), pose)[static_cast<size_t>(std::ranges::find(names, name) - names.begin())];
}

// How far apart two points are seen, metres at their distance.
double seen_apart(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d ray = (a - kEye).normalized();
  return (b - a - ray * ray.dot(b - a)).norm();
}

TEST(ExchangedInImage, HandsAreSeenWhereTheOtherWas) {
  const Skeleton& skeleton = human().skeleton;
  const std::vector<Limb>& limbs = human().profile.limbs;
  const std::vector<double> pose = reaching_pose();
  int found = 0;
  for (const auto& [a, b] : human().profile.limb_pairs) {
    if (!skeleton.dofs()[static_cast<size_t>(limbs[a].dofs.front())].name.ends_with("upper_arm_rx")) continue;
    ++found;
    constexpr int kSeeds = 10;
    std::map<std::string, double> mean;
    for (uint64_t seed = 1; seed <= kSeeds; ++seed) {
      Rng rng(seed);
      const auto exchanged = exchanged_in_image(human(), limbs[a], limbs[b], pose, kEye, rng);
      ASSERT_EQ(exchanged.size(), pose.size());
      for (const auto& [hand, other] : {std::pair{"right_hand", "left_hand"}, std::pair{"left_hand", "right_hand"}}) {
        EXPECT_GT(seen_apart(place_of(hand, pose), place_of(other, pose)), 0.4);
        const double off = seen_apart(place_of(hand, exchanged), place_of(other, pose));
        // Elbows must fit, too, from another shoulder: the best of some random tries. Seeds 1 to 40 gave up to 0.234.
        EXPECT_LT(off, 0.25) << hand << seed;
        mean[hand] += off / kSeeds;
      }
      for (const char* still : {"right_foot", "left_foot", "head_top"}) {
        EXPECT_LT((place_of(still, exchanged) - place_of(still, pose)).norm(), 1e-9) << still;
      }
    }
    for (const auto& [hand, off] : mean) EXPECT_LT(off, 0.2) << hand;
  }
  EXPECT_EQ(found, 1);
}

TEST(TurnedInImage, HandsAndFeetStayWhereTheyAreSeen) {
  const std::vector<double> pose = reaching_pose();
  const auto turned = turned_in_image(human(), pose, to_radians(40), kEye);
  ASSERT_EQ(turned.size(), pose.size());
  const auto turn = static_cast<size_t>(*human().profile.heading);
  EXPECT_NEAR(wrap_angle(turned[turn] - pose[turn]), to_radians(40), 1e-9);
  for (const char* end : {"right_foot", "left_foot", "right_hand", "left_hand"}) {
    EXPECT_LT(seen_apart(place_of(end, turned), place_of(end, pose)), 0.1) << end;
  }
}

TEST(ImageMoves, StayWithinLimitsAndABodyWithoutPairsIsOnlyTurned) {
  Rng rng(1);
  const auto moves = depth_ambiguity_moves(human(), reaching_pose(), kEye, rng);
  EXPECT_EQ(moves.size(), 6u);  // legs, arms, both; turned either way; mirrored
  for (const auto& move : moves) {
    auto clamped = move;
    human().skeleton.clamp(clamped);
    for (size_t d = 0; d < move.size(); ++d) EXPECT_NEAR(move[d], clamped[d], 1e-9) << human().skeleton.dofs()[d].name;
  }
  const BodyModel tube = make_test_body();
  EXPECT_EQ(depth_ambiguity_moves(tube, std::vector<double>(8, 0.0), kEye, rng).size(), 3u);
}

}  // namespace
}  // namespace silpose
