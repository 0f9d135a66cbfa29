#include "silpose/body/girth.h"

#include <algorithm>
#include <utility>

#include "silpose/base/check.h"
#include "silpose/body/collision_spheres.h"

namespace silpose {
namespace {

using Eigen::Vector3d;

constexpr double kWhole = 0.06, kGroup = 0.06;  // deviations

// Along a bone: towards the joints below; of a last joint, towards the middle of its flesh.
Vector3d along_bone(const Skeleton& skeleton, size_t joint_idx, const Vector3d& flesh_centre) {
  Vector3d along = Vector3d::Zero();
  for (const Joint& joint : skeleton.joints()) {
    if (joint.parent_idx == static_cast<int>(joint_idx)) along += joint.offset_in_parent;
  }
  if (along.norm() < 1e-6) along = flesh_centre;
  return along.norm() < 1e-6 ? Vector3d::UnitY() : along.normalized();
}

}  // namespace

Girths::Girths(BodyModel body) : body_(std::move(body)), volume_(volume(body_.rest)) {
  const auto centres = segment_centres(body_);
  bones_.resize(centres.size());
  for (size_t j = 0; j < centres.size(); ++j) {
    if (!centres[j]) continue;
    const Rigid3 rest_from_joint = body_.joint_from_rest[j].inverse();
    const std::string name(without_side(body_.skeleton.joints()[j].name));
    const auto group = std::ranges::find(names_, name) - names_.begin();
    if (group == std::ssize(names_)) names_.push_back(name);
    bones_[j] = {rest_from_joint * *centres[j], rest_from_joint.rotation * along_bone(body_.skeleton, j, *centres[j]),
                 static_cast<int>(group)};
  }
}

Eigen::MatrixXd Girths::covariance() const {
  const auto G = std::ssize(names_);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Constant(G, G, kWhole * kWhole);
  covariance.diagonal().array() += kGroup * kGroup;
  return covariance;
}

BodyModel Girths::applied(std::span<const double> girths) const {
  check(girths.size() == names_.size(), "Girths: {} girths for {} groups of bones", girths.size(), names_.size());
  for (const double girth : girths) check(girth > -1, "Girths: a girth of {}", girth);
  BodyModel out = body_;
  for (size_t v = 0; v < body_.rest.vertices.size(); ++v) {
    const Vector3d x = body_.rest.vertices[v].cast<double>();
    Vector3d moved = x;
    for (uint32_t i = body_.skin.row_start[v]; i < body_.skin.row_start[v + 1]; ++i) {
      const Bone& bone = bones_[body_.skin.joint_idx[i]];
      if (bone.group < 0) continue;
      const Vector3d off = x - bone.point;
      moved += static_cast<double>(body_.skin.weight[i]) * girths[static_cast<size_t>(bone.group)] *
               (off - off.dot(bone.direction) * bone.direction);
    }
    out.rest.vertices[v] = moved.cast<float>();
  }
  if (volume_ > 0) out.weight_kg *= volume(out.rest) / volume_;
  return out;
}

}  // namespace silpose
