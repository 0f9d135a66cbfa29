#include "silpose/track/limbs.h"

#include <algorithm>
#include <string>
#include <utility>

namespace silpose {
namespace {

// Joint -> index of its limb, or -1: the trunk.
std::vector<int> limb_of_joint(const Skeleton& skeleton, std::vector<Limb>& limbs) {
  const auto joints = skeleton.joints();
  std::vector<int> num_children(joints.size(), 0);
  for (const Joint& joint : joints) {
    if (joint.parent_idx >= 0) ++num_children[joint.parent_idx];
  }
  // Parents come first, so one pass from the end shows whether a subtree branches.
  std::vector<bool> branches(joints.size(), false);
  for (size_t j = joints.size(); j-- > 0;) {
    if (num_children[j] > 1) branches[j] = true;
    if (branches[j] && joints[j].parent_idx >= 0) branches[joints[j].parent_idx] = true;
  }
  std::vector<int> limb_of(joints.size(), -1);
  for (size_t j = 0; j < joints.size(); ++j) {
    if (branches[j]) continue;
    const int parent = joints[j].parent_idx;
    if (parent >= 0 && limb_of[parent] >= 0) {
      limb_of[j] = limb_of[parent];
    } else {
      limb_of[j] = static_cast<int>(limbs.size());
      limbs.emplace_back();
    }
    limbs[limb_of[j]].joints.push_back(static_cast<int>(j));
  }
  for (int d = 0; d < skeleton.num_dofs(); ++d) {
    const int limb = limb_of[skeleton.dofs()[static_cast<size_t>(d)].joint_idx];
    if (limb >= 0) limbs[limb].dofs.push_back(d);
  }
  return limb_of;
}

}  // namespace

std::vector<Limb> limbs_of(const Skeleton& skeleton) {
  std::vector<Limb> limbs;
  limb_of_joint(skeleton, limbs);
  std::erase_if(limbs, [](const Limb& limb) { return limb.dofs.empty(); });
  return limbs;
}

std::vector<std::vector<int>> limb_blocks(const Skeleton& skeleton) {
  std::vector<std::vector<int>> blocks;
  std::vector<bool> in_limb(skeleton.dofs().size(), false);
  for (Limb& limb : limbs_of(skeleton)) {
    for (const int d : limb.dofs) in_limb[static_cast<size_t>(d)] = true;
    blocks.push_back(std::move(limb.dofs));
  }
  std::vector<int> trunk;
  for (int d = 0; d < skeleton.num_dofs(); ++d) {
    if (!in_limb[static_cast<size_t>(d)]) trunk.push_back(d);
  }
  if (!trunk.empty()) blocks.push_back(std::move(trunk));
  return blocks;
}

std::vector<std::pair<size_t, size_t>> alike_limbs(const Skeleton& skeleton, std::span<const Limb> limbs) {
  const auto name = [&](int d) { return without_side(skeleton.dofs()[static_cast<size_t>(d)].name); };
  std::vector<std::pair<size_t, size_t>> pairs;
  for (size_t i = 0; i < limbs.size(); ++i) {
    for (size_t j = i + 1; j < limbs.size(); ++j) {
      const auto &a = limbs[i].dofs, &b = limbs[j].dofs;
      if (std::equal(a.begin(), a.end(), b.begin(), b.end(), [&](int x, int y) { return name(x) == name(y); })) {
        pairs.emplace_back(i, j);
      }
    }
  }
  return pairs;
}

std::optional<int> turning_dof(const Skeleton& skeleton) {
  for (const int d : skeleton.joints().front().dof_indices) {
    const Dof& dof = skeleton.dofs()[static_cast<size_t>(d)];
    if (!dof.is_translation) return dof.axis.y() == 1 ? std::optional(d) : std::nullopt;
  }
  return std::nullopt;
}

}  // namespace silpose
