#include "silpose/fit/limb_variants.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "silpose/fit/limb_reach.h"

namespace silpose {

void exchange(std::span<double> pose, const Limb& a, const Limb& b) {
  for (size_t k = 0; k < a.dofs.size(); ++k) {
    std::swap(pose[static_cast<size_t>(a.dofs[k])], pose[static_cast<size_t>(b.dofs[k])]);
  }
}

std::vector<std::vector<double>> reflected_limb(const BodyModel& body, const Limb& limb, std::span<const double> pose,
                                                const Eigen::Vector3d& camera_centre) {
  constexpr double kReached = 0.05;  // [guess] metres
  std::vector<std::vector<double>> variants;
  const std::vector<LimbPoint> points = limb_points(body, limb);
  if (points.size() < 2) return variants;
  const std::vector<Eigen::Vector3d> x = positions(body.skeleton, points, pose);
  const Eigen::Vector3d ray = (x.front() - camera_centre).normalized();
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
                                       const Eigen::Vector3d& camera_centre, int num_random, double two_at_once,
                                       Rng& rng) {
  std::vector<LimbVariant> variants;
  for (size_t l = 0; l < limbs.size(); ++l) {
    for (auto& reflected : reflected_limb(body, limbs[l], pose, camera_centre))
      variants.push_back({{l}, std::move(reflected)});
  }
  for (const auto& [a, b] : body.profile.limb_pairs) {
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

std::vector<double> mirrored_in_depth(const BodyModel& body, std::span<const double> pose,
                                      const Eigen::Vector3d& camera_centre) {
  const Skeleton& skeleton = body.skeleton;
  const std::optional<int> turn = body.profile.heading;
  if (!turn || !body.profile.facing) return {};
  const Eigen::Vector3d root = skeleton.forward_kinematics(pose).front().translation;
  const std::vector<double> zero(pose.size(), 0.0);
  const std::vector<Rigid3> world_from_joint = skeleton.forward_kinematics(zero);
  const Eigen::Matrix3Xd axes = skeleton.dof_axes(zero, world_from_joint);
  const Eigen::Vector3d facing = world_from_joint.front().rotation * *body.profile.facing;
  const Eigen::Vector3d across = Eigen::Vector3d::UnitY().cross(facing);
  // The body's own mirror image, right and left exchanged: a turn about an axis across the body stays, one about an
  // axis in the mirror's plane changes its sign. Limbs that are alike have axes that are mirrored already.
  std::vector<double> mirrored(pose.begin(), pose.end());
  std::vector<bool> paired(pose.size(), false);
  const std::vector<Limb>& limbs = body.profile.limbs;
  for (const auto& [a, b] : body.profile.limb_pairs) {
    exchange(mirrored, limbs[a], limbs[b]);
    for (const size_t limb : {a, b}) {
      for (const int d : limbs[limb].dofs) paired[static_cast<size_t>(d)] = true;
    }
  }
  for (size_t d = 0; d < mirrored.size(); ++d) {
    const bool stays = std::abs(axes.col(static_cast<Eigen::Index>(d)).dot(across)) >= 0.5;
    if (!paired[d] && !skeleton.dofs()[d].is_translation && !stays) mirrored[d] = -mirrored[d];
  }
  // From the body's own mirror plane to the one through the root that faces the camera.
  const Eigen::Vector3d towards = camera_centre - root;
  double& heading = mirrored[static_cast<size_t>(*turn)];
  heading =
      wrap_angle(heading + kPi + 2 * std::atan2(towards.x(), towards.z()) - 2 * std::atan2(facing.x(), facing.z()));
  skeleton.clamp(mirrored);
  return mirrored;
}

}  // namespace silpose
