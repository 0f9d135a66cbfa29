#include "silpose/track/limbs.h"

#include <algorithm>
#include <map>
#include <string>
#include <utility>

namespace silpose {

std::vector<std::vector<int>> limb_blocks(const Skeleton& skeleton) {
  const auto joints = skeleton.joints();
  const int num_joints = skeleton.num_joints();
  std::vector<int> num_children(joints.size(), 0);
  for (const Joint& joint : joints) {
    if (joint.parent_idx >= 0) ++num_children[joint.parent_idx];
  }
  // Parents come first, so one pass from the end tells whether a subtree branches.
  std::vector<bool> branches(joints.size(), false);
  for (int j = num_joints - 1; j >= 0; --j) {
    if (num_children[j] > 1) branches[j] = true;
    if (branches[j] && joints[j].parent_idx >= 0) branches[joints[j].parent_idx] = true;
  }
  // The limb of a joint is its topmost ancestor below which nothing branches; -1 is the trunk.
  std::vector<int> limb_of(joints.size(), -1);
  std::map<int, std::vector<int>> dofs_of;
  for (int j = 0; j < num_joints; ++j) {
    if (!branches[j]) {
      const int parent = joints[j].parent_idx;
      limb_of[j] = parent >= 0 && limb_of[parent] >= 0 ? limb_of[parent] : j;
    }
  }
  for (int d = 0; d < skeleton.num_dofs(); ++d) dofs_of[limb_of[skeleton.dofs()[d].joint_idx]].push_back(d);

  std::vector<std::vector<int>> blocks;
  for (auto& [limb, dofs] : dofs_of) {
    if (limb >= 0) blocks.push_back(std::move(dofs));
  }
  if (dofs_of.contains(-1)) blocks.push_back(std::move(dofs_of[-1]));
  return blocks;
}

std::vector<std::vector<double>> exchanged_limbs(const Skeleton& skeleton, std::span<const double> pose) {
  const auto name_without_side = [&](int d) {
    const std::string& name = skeleton.dofs()[static_cast<size_t>(d)].name;
    return name.starts_with("right_") ? name.substr(6) : name.starts_with("left_") ? name.substr(5) : name;
  };
  const auto alike = [&](const std::vector<int>& a, const std::vector<int>& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [&](int i, int j) { return name_without_side(i) == name_without_side(j); });
  };
  const auto limbs = limb_blocks(skeleton);
  std::vector<std::vector<double>> variants;
  std::vector<double> all(pose.begin(), pose.end());
  for (size_t i = 0; i < limbs.size(); ++i) {
    for (size_t j = i + 1; j < limbs.size(); ++j) {
      if (!alike(limbs[i], limbs[j])) continue;
      std::vector<double> one(pose.begin(), pose.end());
      for (size_t k = 0; k < limbs[i].size(); ++k) {
        const auto a = static_cast<size_t>(limbs[i][k]), b = static_cast<size_t>(limbs[j][k]);
        std::swap(one[a], one[b]);
        std::swap(all[a], all[b]);
      }
      variants.push_back(std::move(one));
    }
  }
  if (variants.size() > 1) variants.push_back(std::move(all));
  return variants;
}

}  // namespace silpose
