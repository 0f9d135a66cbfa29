#include "silpose/body/girth.h"

#include <algorithm>
#include <string_view>

#include "silpose/base/check.h"
#include "silpose/body/bone_mass.h"

namespace silpose {
namespace {

using Eigen::Vector3d;

constexpr double kWhole = 0.06, kGroup = 0.06;  // deviations

// The middle line of a bone's flesh in the rest pose.
struct Line {
  Vector3d point = Vector3d::Zero(), direction = Vector3d::UnitY();
  bool has_flesh = false;
};

// Towards the joints below; of a last joint, towards the middle of its flesh.
Line middle_line(const BodyModel& body, const BoneMass& bone) {
  const auto joints = body.skeleton.joints();
  Vector3d along = Vector3d::Zero();
  for (const Joint& joint : joints) {
    if (joint.parent_idx == bone.joint_idx) along += joint.offset_in_parent;
  }
  if (along.norm() < 1e-6) along = bone.centre_in_joint;
  if (along.norm() < 1e-6) along = Vector3d::UnitY();
  const Rigid3 rest_from_joint = body.joint_from_rest[static_cast<size_t>(bone.joint_idx)].inverse();
  return {rest_from_joint * bone.centre_in_joint, rest_from_joint.rotation * along.normalized(), true};
}

// Name of the group of each joint [J], and whether it has flesh.
std::vector<std::string> groups_of(const BodyModel& body, const std::vector<BoneMass>& masses) {
  std::vector<std::string> groups(body.skeleton.joints().size());
  for (const BoneMass& bone : masses) {
    const auto j = static_cast<size_t>(bone.joint_idx);
    groups[j] = without_side(body.skeleton.joints()[j].name);
  }
  return groups;
}

std::vector<std::string> names_of(const std::vector<std::string>& groups) {
  std::vector<std::string> names;
  for (const std::string& group : groups) {
    if (!group.empty() && std::ranges::find(names, group) == names.end()) names.push_back(group);
  }
  return names;
}

}  // namespace

std::vector<std::string> girth_names(const BodyModel& body) { return names_of(groups_of(body, bone_masses(body))); }

Eigen::MatrixXd girth_covariance(size_t num_girths) {
  const auto G = static_cast<Eigen::Index>(num_girths);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Constant(G, G, kWhole * kWhole);
  covariance.diagonal().array() += kGroup * kGroup;
  return covariance;
}

BodyModel with_girths(const BodyModel& body, std::span<const double> girths) {
  const std::vector<BoneMass> masses = bone_masses(body);
  const std::vector<std::string> groups = groups_of(body, masses), names = names_of(groups);
  check(girths.size() == names.size(), "with_girths: {} girths for {} groups of bones", girths.size(), names.size());
  for (const double girth : girths) check(girth > -1, "with_girths: a girth of {}", girth);
  std::vector<Line> lines(groups.size());
  std::vector<double> girth_of(groups.size(), 0);
  for (const BoneMass& bone : masses) {
    const auto j = static_cast<size_t>(bone.joint_idx);
    lines[j] = middle_line(body, bone);
    girth_of[j] = girths[static_cast<size_t>(std::ranges::find(names, groups[j]) - names.begin())];
  }
  BodyModel out = body;
  for (size_t v = 0; v < body.rest.vertices.size(); ++v) {
    const Vector3d x = body.rest.vertices[v].cast<double>();
    Vector3d moved = x;
    for (uint32_t i = body.skin.row_start[v]; i < body.skin.row_start[v + 1]; ++i) {
      const size_t j = body.skin.joint_idx[i];
      const Vector3d off = x - lines[j].point;
      moved += static_cast<double>(body.skin.weight[i]) * girth_of[j] *
               (off - off.dot(lines[j].direction) * lines[j].direction);
    }
    out.rest.vertices[v] = moved.cast<float>();
  }
  const double before = volume(body.rest);
  if (before > 0) out.weight_kg *= volume(out.rest) / before;
  return out;
}

}  // namespace silpose
