#include "silpose/body/rig_profile.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "silpose/base/check.h"

namespace silpose {
namespace {

using Eigen::Vector3d;

constexpr double kShortChain = 0.2;  // [guess] of the longest chain: fingers and ears are no limbs of their own
constexpr int kMostInLimb = 4;       // [guess] moving joints of a limb: a longer chain has several
constexpr double kMirrored = 0.05;   // [guess] of the longest chain: how far mirrored joints may be apart
constexpr double kAlike = 0.9;       // [guess] cosine between mirrored axes
constexpr double kNoiseUp_m = 0.010, kNoiseAlong_m = 0.020;  // [guess] as the human's: a walker's in 1/30 s
constexpr double kNoiseTurn_deg = 2, kNoiseOfRange = 0.03, kLeastNoise_deg = 1, kMostNoise_deg = 5;  // [guess]
constexpr double kAcceleration_m = 0.008, kAccelerationOfNoise = 0.5;                                // [guess]
constexpr double kRestOfRange = 0.25;                                                                // [guess]
constexpr double kBendOfRange = 0.3, kMostBend = kPi / 2;  // [guess] of a starting pose: of each joint, of all together

// The joints' frames and the DOF's axes in the zero pose, world coordinates.
struct ZeroPose {
  explicit ZeroPose(const Skeleton& skeleton) {
    const std::vector<double> zero(static_cast<size_t>(skeleton.num_dofs()), 0.0);
    world_from_joint = skeleton.forward_kinematics(zero);
    axes = skeleton.dof_axes(zero, world_from_joint);
  }
  std::vector<Rigid3> world_from_joint;  // [J]
  Eigen::Matrix3Xd axes;                 // [3, D]
};

// The tree, seen from the root, by joint.
struct Tree {
  explicit Tree(const Skeleton& skeleton) {
    const auto joints = skeleton.joints();
    const size_t J = joints.size();
    reach.assign(J, 0.0);
    next.assign(J, -1);
    is_moving.assign(J, false);
    is_branching.assign(J, false);
    std::vector<bool> below_moves(J, false);
    std::vector<double> below(J, -1.0);
    for (size_t j = J; j-- > 0;) {  // children come after their parents
      is_moving[j] = !joints[j].dof_indices.empty();
      below_moves[j] = below_moves[j] || is_moving[j];
      reach[j] = joints[j].offset_in_parent.norm() + std::max(below[j], 0.0);
      if (joints[j].parent_idx < 0) continue;
      const auto parent = static_cast<size_t>(joints[j].parent_idx);
      longest = std::max(longest, reach[j]);
      if (!below_moves[j]) continue;
      below_moves[parent] = true;
      if (reach[j] >= below[parent]) below[parent] = reach[j], next[parent] = static_cast<int>(j);
    }
    std::vector<int> num_chains(J, 0);
    is_chain.assign(J, false);
    for (size_t j = J; j-- > 0;) {
      if (num_chains[j] > 1 || joints[j].parent_idx < 0) is_branching[j] = true;
      if (joints[j].parent_idx < 0) continue;
      const auto parent = static_cast<size_t>(joints[j].parent_idx);
      is_chain[j] = below_moves[j] && reach[j] >= kShortChain * longest;
      num_chains[parent] += is_chain[j] ? 1 : 0;
      if (is_branching[j]) is_branching[parent] = true;
    }
  }
  double longest = 0;
  std::vector<double> reach;       // [J] from the parent to the furthest joint below
  std::vector<int> next;           // [J] the child in which the longest chain continues; -1: none
  std::vector<bool> is_moving;     // [J] has DOF
  std::vector<bool> is_chain;      // [J] with what is below it, long enough for a limb
  std::vector<bool> is_branching;  // [J] trunk: limbs, or the trunk, branch at it or below; the root
};

std::vector<Limb> limbs_of_tree(const Skeleton& skeleton) {
  const Tree tree(skeleton);
  const auto joints = skeleton.joints();
  std::vector<Limb> limbs;
  std::vector<int> limb_of(joints.size(), -1), num_moving;
  for (size_t j = 0; j < joints.size(); ++j) {
    if (tree.is_branching[j]) continue;
    const auto parent = static_cast<size_t>(joints[j].parent_idx);  // the root branches
    int limb = limb_of[parent];
    if (limb < 0 && !tree.is_chain[j]) continue;
    const bool is_on_chain =
        limb < 0 || (tree.next[parent] == static_cast<int>(j) && limbs[limb].joints.back() == joints[j].parent_idx);
    if (limb < 0 || (is_on_chain && tree.is_moving[j] && num_moving[limb] == kMostInLimb)) {
      limb = static_cast<int>(limbs.size());
      limbs.emplace_back();
      num_moving.push_back(0);
    }
    limb_of[j] = limb;
    if (is_on_chain) {
      limbs[limb].joints.push_back(static_cast<int>(j));
      num_moving[limb] += tree.is_moving[j] ? 1 : 0;
    }
  }
  for (int d = 0; d < skeleton.num_dofs(); ++d) {
    const int limb = limb_of[skeleton.dofs()[d].joint_idx];
    if (limb >= 0) limbs[limb].dofs.push_back(d);
  }
  std::erase_if(limbs, [](const Limb& limb) { return limb.dofs.empty(); });
  return limbs;
}

bool have_alike_names(const Skeleton& skeleton, const Limb& a, const Limb& b) {
  const auto name = [&](int d) { return without_side(skeleton.dofs()[d].name); };
  return std::ranges::equal(a.dofs, b.dofs, {}, name, name);
}

// Whether the limbs are each other's mirror image in the plane x = 0, and not in it.
bool are_mirrored(const Skeleton& skeleton, const ZeroPose& zero, const Limb& a, const Limb& b) {
  if (a.joints.size() != b.joints.size() || a.dofs.size() != b.dofs.size()) return false;
  const double near = kMirrored * Tree(skeleton).longest;
  double apart = 0;
  for (size_t i = 0; i < a.joints.size(); ++i) {
    const Vector3d x = zero.world_from_joint[a.joints[i]].translation;
    const Vector3d y = zero.world_from_joint[b.joints[i]].translation;
    if ((Vector3d(-x.x(), x.y(), x.z()) - y).norm() > near) return false;
    apart = std::max(apart, (x - y).norm());
  }
  if (!(apart > near)) return false;
  for (size_t i = 0; i < a.dofs.size(); ++i) {
    const Dof &one = skeleton.dofs()[a.dofs[i]], &other = skeleton.dofs()[b.dofs[i]];
    if (one.is_translation != other.is_translation) return false;
    Vector3d axis = zero.axes.col(a.dofs[i]);
    axis = one.is_translation ? Vector3d(-axis.x(), axis.y(), axis.z()) : Vector3d(axis.x(), -axis.y(), -axis.z());
    if (axis.dot(zero.axes.col(b.dofs[i])) < kAlike) return false;
  }
  return true;
}

std::vector<RigProfile::LimbPair> pairs_of(const Skeleton& skeleton, const ZeroPose& zero,
                                           std::span<const Limb> limbs) {
  std::vector<RigProfile::LimbPair> pairs;
  std::vector<bool> is_paired(limbs.size(), false);
  for (size_t i = 0; i < limbs.size(); ++i) {
    for (size_t j = i + 1; j < limbs.size(); ++j) {
      if (is_paired[i] || is_paired[j]) continue;
      if (!have_alike_names(skeleton, limbs[i], limbs[j]) && !are_mirrored(skeleton, zero, limbs[i], limbs[j]))
        continue;
      const auto left = [&](size_t l) { return zero.world_from_joint[limbs[l].joints.back()].translation.x(); };
      is_paired[i] = is_paired[j] = true;
      if (left(i) > left(j)) {
        pairs.push_back({j, i});
      } else {
        pairs.push_back({i, j});
      }
    }
  }
  return pairs;
}

// For each pair of limbs, the first joint of either that moves.
std::vector<RigProfile::JointPair> across_of(const Skeleton& skeleton, const RigProfile& profile) {
  const auto first = [&](const Limb& limb) {
    const auto moves = [&](int j) { return !skeleton.joints()[j].dof_indices.empty(); };
    const auto found = std::ranges::find_if(limb.joints, moves);
    return found == limb.joints.end() ? limb.joints.front() : *found;
  };
  std::vector<RigProfile::JointPair> pairs;
  for (const auto& [right, left] : profile.limb_pairs) {
    pairs.push_back({first(profile.limbs[right]), first(profile.limbs[left])});
  }
  return pairs;
}

struct Deviations {
  double noise = 0, acceleration = 0, rest = 0;
};

Deviations default_deviations(const Dof& dof, const Vector3d& axis_in_world) {
  if (dof.is_translation) {
    return {std::abs(axis_in_world.y()) > 0.5 ? kNoiseUp_m : kNoiseAlong_m, kAcceleration_m, 0};
  }
  const double range = dof.upper - dof.lower;
  const double noise_deg =
      dof.is_periodic ? kNoiseTurn_deg : std::clamp(kNoiseOfRange * to_degrees(range), kLeastNoise_deg, kMostNoise_deg);
  const bool is_anywhere = dof.is_shape || dof.is_periodic || dof.joint_idx == 0;
  return {to_radians(noise_deg), to_radians(kAccelerationOfNoise * noise_deg), is_anywhere ? 0 : kRestOfRange * range};
}

void add_deviations(const Skeleton& skeleton, const ZeroPose& zero, RigProfile& profile) {
  for (size_t d = profile.noise.size(); d < skeleton.dofs().size(); ++d) {
    const Deviations added = default_deviations(skeleton.dofs()[d], zero.axes.col(static_cast<Eigen::Index>(d)));
    profile.noise.push_back(added.noise);
    profile.acceleration.push_back(added.acceleration);
    profile.rest.push_back(added.rest);
    profile.rest_if_seen.push_back(added.rest);
  }
}

// At rest; curled about each coordinate axis either way; at rest, turned about the root's other periodic rotations.
std::vector<RigProfile::NamedPose> default_poses(const Skeleton& skeleton, const ZeroPose& zero,
                                                 std::optional<int> heading) {
  const std::vector<double> rest(static_cast<size_t>(skeleton.num_dofs()), 0.0);
  std::vector<RigProfile::NamedPose> poses = {{"rest", rest}};
  for (int k = 0; k < 3; ++k) {
    const std::vector<int> bending = find_dofs(skeleton, [&](const Dof& dof) {
      const auto d = &dof - skeleton.dofs().data();
      return dof.joint_idx > 0 && !dof.is_translation && !dof.is_periodic && std::abs(zero.axes(k, d)) > 0.7;
    });
    if (bending.empty()) continue;
    const double most = kMostBend / static_cast<double>(bending.size());
    for (const double sign : {1.0, -1.0}) {
      RigProfile::NamedPose bent{std::string("bent ") + (sign > 0 ? "+" : "-") + "xyz"[k], rest};
      for (const int d : bending) {
        const bool upwards = sign * zero.axes(k, d) > 0;
        const double limit = upwards ? skeleton.dofs()[d].upper : skeleton.dofs()[d].lower;
        bent.pose[d] = std::clamp(kBendOfRange * limit, -most, most);
      }
      if (bent.pose != rest) poses.push_back(std::move(bent));
    }
  }
  for (int d = 0; d < skeleton.num_dofs(); ++d) {
    const Dof& dof = skeleton.dofs()[d];
    if (dof.joint_idx != 0 || !dof.is_periodic || d == heading) continue;
    for (const double quarters : {1.0, 2.0, -1.0}) {
      poses.push_back({dof.name + " turned", rest});
      poses.back().pose[d] = quarters * kPi / 2;
    }
  }
  return poses;
}

std::optional<int> heading_of(const Skeleton& skeleton, const ZeroPose& zero) {
  for (const int d : skeleton.joints().front().dof_indices) {
    if (skeleton.dofs()[d].is_translation) continue;
    return zero.axes(1, d) > 1 - 1e-9 ? std::optional(d) : std::nullopt;
  }
  return std::nullopt;
}

}  // namespace

std::string_view RigProfile::landmark_called(std::string_view other_name, std::string_view format) const {
  for (const Landmark& landmark : landmarks) {
    const auto found = landmark.other_names.find(std::string(format));
    if (found != landmark.other_names.end() && found->second == other_name) return landmark.name;
  }
  return {};
}

bool RigProfile::has_landmark(std::string_view name) const {
  return std::ranges::find(landmarks, name, &Landmark::name) != landmarks.end();
}

RigProfile tree_profile(const Skeleton& skeleton) {
  RigProfile profile;
  if (skeleton.num_joints() == 0) return profile;
  const ZeroPose zero(skeleton);
  for (const int d : skeleton.joints().front().dof_indices) {
    if (skeleton.dofs()[d].is_translation) profile.root_translations.push_back(d);
  }
  profile.heading = heading_of(skeleton, zero);
  if (profile.heading) profile.up = zero.world_from_joint.front().rotation.transpose() * Vector3d::UnitY();
  profile.limbs = limbs_of_tree(skeleton);
  profile.limb_pairs = pairs_of(skeleton, zero, profile.limbs);
  profile.across = across_of(skeleton, profile);
  for (const Joint& joint : skeleton.joints()) profile.landmarks.push_back({joint.name});
  profile.origin = {skeleton.joints().front().name};
  add_deviations(skeleton, zero, profile);
  profile.poses = default_poses(skeleton, zero, profile.heading);
  return profile;
}

RigProfile extended(RigProfile profile, const Skeleton& skeleton) {
  const int before = static_cast<int>(profile.noise.size());
  check(before <= skeleton.num_dofs(), "extended: a profile of {} DOF for {}", before, skeleton.num_dofs());
  add_deviations(skeleton, ZeroPose(skeleton), profile);
  for (int d = before; d < skeleton.num_dofs(); ++d) {
    const int joint = skeleton.dofs()[d].joint_idx;
    for (Limb& limb : profile.limbs) {
      const auto is_at = [&](int j) { return j == joint; };
      const auto is_of = [&](int other) { return skeleton.dofs()[other].joint_idx == joint; };
      if (!std::ranges::any_of(limb.joints, is_at) && !std::ranges::any_of(limb.dofs, is_of)) continue;
      limb.dofs.push_back(d);
      break;
    }
  }
  for (RigProfile::NamedPose& pose : profile.poses) pose.pose.resize(static_cast<size_t>(skeleton.num_dofs()), 0.0);
  return profile;
}

void check_profile(const RigProfile& profile, const Skeleton& skeleton) {
  const auto D = static_cast<size_t>(skeleton.num_dofs());
  const auto check_index = [](const char* what, int index, int count) {
    check(index >= 0 && index < count, "rig profile: {} {} of {}", what, index, count);
  };
  check(profile.root_translations.size() <= 3, "rig profile: {} root translations", profile.root_translations.size());
  for (const int d : profile.root_translations) {
    check_index("root translation", d, skeleton.num_dofs());
    check(skeleton.dofs()[d].is_translation, "rig profile: root translation '{}' is none", skeleton.dofs()[d].name);
  }
  if (profile.heading) {
    check_index("heading", *profile.heading, skeleton.num_dofs());
    check(!skeleton.dofs()[*profile.heading].is_translation, "rig profile: the heading is a translation");
  }
  for (const auto& axis : {profile.up, profile.facing}) {
    check(!axis || std::abs(axis->norm() - 1) < 1e-6, "rig profile: an axis is not a unit vector");
  }
  std::vector<int> uses(D, 0);
  for (const Limb& limb : profile.limbs) {
    check(!limb.joints.empty() && !limb.dofs.empty(), "rig profile: a limb without joints or DOF");
    for (const int j : limb.joints) check_index("joint of a limb", j, skeleton.num_joints());
    for (const int d : limb.dofs) check_index("DOF of a limb", d, skeleton.num_dofs());
    for (const int d : limb.dofs) check(++uses[d] == 1, "rig profile: DOF {} is in two limbs", d);
  }
  for (const auto& [right, left] : profile.limb_pairs) {
    check(right < profile.limbs.size() && left < profile.limbs.size() && right != left &&
              profile.limbs[right].dofs.size() == profile.limbs[left].dofs.size(),
          "rig profile: limbs {} and {} of {} are no pair", right, left, profile.limbs.size());
  }
  for (const auto& [right, left] : profile.across) {
    for (const int j : {right, left}) check_index("joint across the trunk", j, skeleton.num_joints());
  }
  for (const int j : profile.contact_joints) check_index("contact joint", j, skeleton.num_joints());
  for (const auto* of : {&profile.noise, &profile.acceleration, &profile.rest, &profile.rest_if_seen}) {
    check(of->size() == D, "rig profile: {} deviations for {} DOF", of->size(), D);
    for (const double deviation : *of) {
      check(std::isfinite(deviation) && deviation >= 0, "rig profile: a deviation of {}", deviation);
    }
  }
  for (const auto& [name, pose] : profile.poses) {
    const auto is_finite = [](double value) { return std::isfinite(value); };
    check(pose.size() == D && std::ranges::all_of(pose, is_finite), "rig profile: pose '{}' of {} values for {} DOF",
          name, pose.size(), D);
  }
  check(std::isfinite(profile.silhouette_area) && profile.silhouette_area >= 0, "rig profile: a silhouette area of {}",
        profile.silhouette_area);
}

BodySide side_of(const RigProfile& profile, const Skeleton& skeleton, int joint_idx) {
  check(joint_idx >= 0 && joint_idx < skeleton.num_joints(), "side_of: no joint {}", joint_idx);
  for (int j = joint_idx; j >= 0; j = skeleton.joints()[j].parent_idx) {
    for (const auto& [right, left] : profile.limb_pairs) {
      if (std::ranges::count(profile.limbs[right].joints, j) > 0) return BodySide::kRight;
      if (std::ranges::count(profile.limbs[left].joints, j) > 0) return BodySide::kLeft;
    }
  }
  return BodySide::kMiddle;
}

void place_root(const Skeleton& skeleton, const RigProfile& profile, std::span<double> pose,
                const Eigen::Vector3d& root_in_world) {
  check(std::ssize(pose) == skeleton.num_dofs(), "place_root: pose has {} values, not {}", pose.size(),
        skeleton.num_dofs());
  if (profile.root_translations.empty()) return;
  for (const int d : profile.root_translations) pose[d] = 0;
  const std::vector<Rigid3> world_from_joint = skeleton.forward_kinematics(pose);
  const Eigen::Matrix3Xd axes = skeleton.dof_axes(pose, world_from_joint);
  const int joint = skeleton.dofs()[profile.root_translations.front()].joint_idx;
  const Vector3d from = world_from_joint[joint].translation;
  for (const int d : profile.root_translations) {
    const Dof& dof = skeleton.dofs()[d];
    const double value = axes.col(d).dot(root_in_world - from);
    pose[d] = dof.has_limits() ? std::clamp(value, dof.lower, dof.upper) : value;
  }
}

}  // namespace silpose
