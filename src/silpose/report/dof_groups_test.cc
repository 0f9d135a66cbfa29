#include "silpose/report/dof_groups.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace silpose {
namespace {

using testing::ElementsAre;

// A skeleton in which every joint turns about x, except those whose names begin with "fixed".
Skeleton turning(const std::vector<std::pair<std::string, int>>& names_and_parents) {
  std::vector<Joint> joints;
  std::vector<Dof> dofs;
  for (const auto& [name, parent] : names_and_parents) {
    Joint joint{.name = name, .parent_idx = parent};
    if (!name.starts_with("fixed")) {
      joint.dof_indices = {static_cast<int>(dofs.size())};
      dofs.push_back({.name = name + "_rx", .joint_idx = static_cast<int>(joints.size()), .lower = -1, .upper = 1});
    }
    joints.push_back(joint);
  }
  return Skeleton("turning", joints, dofs);
}

TEST(DofGroups, AreChainsBetweenForksAndSidesShareOne) {
  const Skeleton biped = turning({{"root", -1},
                                  {"spine", 0},
                                  {"chest", 1},
                                  {"right_hip", 0},
                                  {"right_knee", 3},
                                  {"right_ankle", 4},
                                  {"left_hip", 0},
                                  {"left_knee", 6},
                                  {"left_ankle", 7}});
  EXPECT_THAT(dof_groups(biped), ElementsAre("root", "spine, chest", "spine, chest", "hip to ankle", "hip to ankle",
                                             "hip to ankle", "hip to ankle", "hip to ankle", "hip to ankle"));
}

TEST(DofGroups, WhatDoesNotMoveIsNoFork) {
  const Skeleton hand = turning({{"root", -1}, {"palm", 0}, {"fixed_nail", 1}, {"finger", 1}, {"fixed_tip", 3}});
  EXPECT_THAT(dof_groups(hand), ElementsAre("root", "palm, finger", "palm, finger"));
  const Skeleton held = turning({{"fixed_base", -1}, {"fixed_post", 0}, {"arm", 1}, {"head", 1}});
  EXPECT_THAT(dof_groups(held), ElementsAre("arm", "head"));
}

TEST(DofGroups, ALongChainIsCutIntoEvenParts) {
  std::vector<std::pair<std::string, int>> joints = {{"root", -1}};
  for (int i = 0; i < 10; ++i) joints.emplace_back("bone_" + std::to_string(i), i);
  const std::vector<std::string> groups = dof_groups(turning(joints));
  EXPECT_EQ(groups[1], "bone_0 to bone_4");
  EXPECT_EQ(groups[5], "bone_0 to bone_4");
  EXPECT_EQ(groups[6], "bone_5 to bone_9");
}

TEST(DofGroups, ASideIsTheBeginningOfAName) {
  EXPECT_EQ(side_of("left_shin_rx"), "left");
  EXPECT_EQ(side_of("right_hand"), "right");
  EXPECT_EQ(side_of("leftover"), "");
}

}  // namespace
}  // namespace silpose
