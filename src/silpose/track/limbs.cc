#include "silpose/track/limbs.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "silpose/track/limb_reach.h"

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

void exchange(std::span<double> pose, const Limb& a, const Limb& b) {
  for (size_t k = 0; k < a.dofs.size(); ++k) {
    std::swap(pose[static_cast<size_t>(a.dofs[k])], pose[static_cast<size_t>(b.dofs[k])]);
  }
}

std::vector<std::vector<double>> exchanged_limbs(const Skeleton& skeleton, std::span<const double> pose) {
  const std::vector<Limb> limbs = limbs_of(skeleton);
  std::vector<std::vector<double>> variants;
  std::vector<double> all(pose.begin(), pose.end());
  for (const auto& [a, b] : alike_limbs(skeleton, limbs)) {
    std::vector<double> one(pose.begin(), pose.end());
    exchange(one, limbs[a], limbs[b]);
    exchange(all, limbs[a], limbs[b]);
    variants.push_back(std::move(one));
  }
  if (variants.size() > 1) variants.push_back(std::move(all));
  return variants;
}

std::vector<std::vector<double>> reflected_limb(const BodyModel& body, const Limb& limb, std::span<const double> pose,
                                                const Eigen::Vector3d& eye) {
  constexpr double kReached = 0.05;  // metres
  std::vector<std::vector<double>> variants;
  const std::vector<LimbPoint> points = limb_points(body, limb);
  if (points.size() < 2) return variants;
  const std::vector<Eigen::Vector3d> x = positions(body.skeleton, points, pose);
  const Eigen::Vector3d ray = (x.front() - eye).normalized();
  const size_t num_segments = points.size() - 1;
  const auto add_reflection = [&](size_t first, size_t last) {
    std::vector<Eigen::Vector3d> targets = x;
    double moved = 0;
    for (size_t s = 0; s < num_segments; ++s) {
      Eigen::Vector3d segment = x[s + 1] - x[s];
      if (s >= first && s < last) segment -= 2 * segment.dot(ray) * ray;
      targets[s + 1] = targets[s] + segment;
      moved = std::max(moved, (targets[s + 1] - x[s + 1]).norm());
    }
    if (moved < kReached) return;
    std::vector<double> variant(pose.begin(), pose.end());
    if (reach_for(body.skeleton, limb, points, targets, Eigen::Matrix3d::Identity(), variant) < kReached)
      variants.push_back(std::move(variant));
  };
  add_reflection(0, 1);
  if (num_segments > 1) {
    add_reflection(1, num_segments);
    add_reflection(0, num_segments);
  }
  return variants;
}

std::vector<double> random_limb(const Skeleton& skeleton, const Limb& limb, std::span<const double> pose, Rng& rng) {
  std::vector<double> variant(pose.begin(), pose.end());
  const bool anywhere = rng.uniform() < 0.5;
  for (const int d : limb.dofs) {
    const Dof& dof = skeleton.dofs()[static_cast<size_t>(d)];
    double& value = variant[static_cast<size_t>(d)];
    value = anywhere ? rng.uniform(dof.lower, dof.upper) : value + 0.2 * (dof.upper - dof.lower) * rng.normal();
  }
  skeleton.clamp(variant);
  return variant;
}

std::vector<LimbVariant> limb_variants(const BodyModel& body, std::span<const Limb> limbs, std::span<const double> pose,
                                       const Eigen::Vector3d& eye, int num_random, double two_at_once, Rng& rng) {
  std::vector<LimbVariant> variants;
  for (size_t l = 0; l < limbs.size(); ++l) {
    for (auto& reflected : reflected_limb(body, limbs[l], pose, eye)) variants.push_back({{l}, std::move(reflected)});
  }
  for (const auto& [a, b] : alike_limbs(body.skeleton, limbs)) {
    LimbVariant exchanged{{a, b}, {pose.begin(), pose.end()}};
    exchange(exchanged.pose, limbs[a], limbs[b]);
    variants.push_back(std::move(exchanged));
  }
  for (int i = 0; i < num_random && !limbs.empty(); ++i) {
    const size_t l = static_cast<size_t>(i) % limbs.size();
    LimbVariant variant{{l}, random_limb(body.skeleton, limbs[l], pose, rng)};
    if (limbs.size() > 1 && two_at_once > 0 && rng.uniform() < two_at_once) {
      const size_t other = (l + 1 + rng.index(limbs.size() - 1)) % limbs.size();
      variant.limbs.push_back(other);
      variant.pose = random_limb(body.skeleton, limbs[other], variant.pose, rng);
    }
    variants.push_back(std::move(variant));
  }
  return variants;
}

std::optional<int> turning_dof(const Skeleton& skeleton) {
  for (const int d : skeleton.joints().front().dof_indices) {
    const Dof& dof = skeleton.dofs()[static_cast<size_t>(d)];
    if (!dof.is_translation) return dof.axis.y() == 1 ? std::optional(d) : std::nullopt;
  }
  return std::nullopt;
}

std::vector<double> mirrored_in_depth(const Skeleton& skeleton, std::span<const double> pose,
                                      const Eigen::Vector3d& eye) {
  const std::optional<int> turn = turning_dof(skeleton);
  if (!turn) return {};
  Eigen::Vector3d root = Eigen::Vector3d::Zero();
  for (const int d : skeleton.joints().front().dof_indices) {
    const Dof& dof = skeleton.dofs()[static_cast<size_t>(d)];
    if (dof.is_translation) root += pose[static_cast<size_t>(d)] * dof.axis;
  }
  // The body's own mirror image, x to -x with right and left exchanged: a turn about (x, y, z) becomes one about
  // (x, -y, -z). Limbs that are alike have axes that are mirrored already.
  std::vector<double> mirrored(pose.begin(), pose.end());
  std::vector<bool> paired(pose.size(), false);
  const std::vector<Limb> limbs = limbs_of(skeleton);
  for (const auto& [a, b] : alike_limbs(skeleton, limbs)) {
    exchange(mirrored, limbs[a], limbs[b]);
    for (const size_t limb : {a, b}) {
      for (const int d : limbs[limb].dofs) paired[static_cast<size_t>(d)] = true;
    }
  }
  for (size_t d = 0; d < mirrored.size(); ++d) {
    const Dof& dof = skeleton.dofs()[d];
    if (!paired[d] && !dof.is_translation && std::abs(dof.axis.x()) < 0.5) mirrored[d] = -mirrored[d];
  }
  // From the plane x = 0 to the one through the root that faces the eye.
  const Eigen::Vector3d towards = eye - root;
  mirrored[static_cast<size_t>(*turn)] =
      wrap_angle(mirrored[static_cast<size_t>(*turn)] + kPi + 2 * std::atan2(towards.x(), towards.z()));
  skeleton.clamp(mirrored);
  return mirrored;
}

}  // namespace silpose
