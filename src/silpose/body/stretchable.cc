#include "silpose/body/stretchable.h"

#include <algorithm>
#include <string>
#include <utility>

#include "silpose/base/check.h"

namespace silpose {
namespace {

constexpr double kShortestBone = 0.08;  // of the body's height: shorter bones stay as they are
// Deviations, relative to a bone's length: of the whole body's size, of each pair of bones, between right and left.
constexpr double kSize = 0.02, kBone = 0.045, kSide = 0.005;

}  // namespace

BodyModel stretchable(const BodyModel& body) {
  const Skeleton& skeleton = body.skeleton;
  std::vector<Joint> joints(skeleton.joints().begin(), skeleton.joints().end());
  std::vector<Dof> dofs(skeleton.dofs().begin(), skeleton.dofs().end());
  for (size_t j = 0; j < joints.size(); ++j) {
    const double length = joints[j].offset_in_parent.norm();
    if (joints[j].parent_idx < 0 || length < kShortestBone * body.height_m) continue;
    const double limit = 3 * length * (kSize + kBone);
    joints[j].dof_indices.insert(joints[j].dof_indices.begin(), static_cast<int>(dofs.size()));
    dofs.push_back({.name = joints[j].name + "_length",
                    .joint_idx = static_cast<int>(j),
                    .is_translation = true,
                    .axis = joints[j].parent_from_rest.transpose() * (joints[j].offset_in_parent / length),
                    .lower = -limit,
                    .upper = limit,
                    .is_shape = true});
  }
  BodyModel out = body;
  out.skeleton = Skeleton(skeleton.name(), std::move(joints), std::move(dofs));
  out.profile = extended(body.profile, out.skeleton);
  return out;
}

BodyModel with_lengths(const BodyModel& body, std::span<const double> lengths) {
  const Skeleton stretched = stretchable(body).skeleton;
  const std::vector<int> shape = shape_dofs(stretched);
  check(lengths.size() == shape.size(), "with_lengths: {} lengths for {} bones", lengths.size(), shape.size());
  const Skeleton& skeleton = body.skeleton;
  std::vector<Joint> joints(skeleton.joints().begin(), skeleton.joints().end());
  for (size_t s = 0; s < shape.size(); ++s) {
    const Dof& dof = stretched.dofs()[static_cast<size_t>(shape[s])];
    Joint& joint = joints[static_cast<size_t>(dof.joint_idx)];
    check(joint.offset_in_parent.norm() + lengths[s] > 0, "with_lengths: {} of {} m", dof.name, lengths[s]);
    joint.offset_in_parent += lengths[s] * stretched.axis_in_parent(shape[s]);
  }
  // How far each joint moves in the mesh's own rest pose; its flesh moves with it.
  std::vector<Eigen::Vector3d> moved(joints.size(), Eigen::Vector3d::Zero());
  for (size_t j = 0; j < joints.size(); ++j) {
    if (joints[j].parent_idx < 0) continue;
    const auto parent = static_cast<size_t>(joints[j].parent_idx);
    const Eigen::Vector3d longer = joints[j].offset_in_parent - skeleton.joints()[j].offset_in_parent;
    moved[j] = moved[parent] + body.joint_from_rest[parent].inverse().rotation * longer;
  }
  BodyModel out = body;
  double lowest_before = 1e30, highest_before = -1e30, lowest = 1e30, highest = -1e30;
  for (size_t v = 0; v < out.rest.vertices.size(); ++v) {
    Eigen::Vector3d x = out.rest.vertices[v].cast<double>();
    lowest_before = std::min(lowest_before, x.y()), highest_before = std::max(highest_before, x.y());
    for (uint32_t i = out.skin.row_start[v]; i < out.skin.row_start[v + 1]; ++i) {
      x += static_cast<double>(out.skin.weight[i]) * moved[out.skin.joint_idx[i]];
    }
    lowest = std::min(lowest, x.y()), highest = std::max(highest, x.y());
    out.rest.vertices[v] = x.cast<float>();
  }
  const Eigen::Vector3d to_floor(0, -lowest, 0);  // the rest mesh stands on it
  for (Eigen::Vector3f& x : out.rest.vertices) x += to_floor.cast<float>();
  for (size_t j = 0; j < joints.size(); ++j) {
    out.joint_from_rest[j] = out.joint_from_rest[j] * Rigid3{Eigen::Matrix3d::Identity(), -(moved[j] + to_floor)};
  }
  out.height_m += (highest - lowest) - (highest_before - lowest_before);
  out.skeleton = Skeleton(skeleton.name(), std::move(joints), {skeleton.dofs().begin(), skeleton.dofs().end()});
  return out;
}

BodyModel scaled(const BodyModel& body, double factor) {
  check(factor > 0, "scaled: by a factor of {}", factor);
  BodyModel out = body;
  std::vector<Joint> joints(body.skeleton.joints().begin(), body.skeleton.joints().end());
  for (Joint& joint : joints) joint.offset_in_parent *= factor;
  out.skeleton =
      Skeleton(body.skeleton.name(), std::move(joints), {body.skeleton.dofs().begin(), body.skeleton.dofs().end()});
  for (Eigen::Vector3f& x : out.rest.vertices) x *= static_cast<float>(factor);
  for (Rigid3& joint_from_rest : out.joint_from_rest) joint_from_rest.translation *= factor;
  for (BodyModel::EndPoint& end : out.end_points) end.offset_in_joint *= factor;
  out.height_m *= factor;
  out.weight_kg *= factor * factor * factor;
  return out;
}

std::vector<int> shape_dofs(const Skeleton& skeleton) {
  return find_dofs(skeleton, [](const Dof& dof) { return dof.is_shape; });
}

Eigen::MatrixXd stretch_covariance(const Skeleton& skeleton) {
  const std::vector<int> indices = shape_dofs(skeleton);
  const auto S = std::ssize(indices);
  Eigen::MatrixXd covariance(S, S);
  const auto length = [&](Eigen::Index i) {
    return skeleton
        .joints()[static_cast<size_t>(skeleton.dofs()[static_cast<size_t>(indices[static_cast<size_t>(i)])].joint_idx)]
        .offset_in_parent.norm();
  };
  for (Eigen::Index i = 0; i < S; ++i) {
    for (Eigen::Index j = 0; j < S; ++j) {
      const std::string& a = skeleton.dofs()[static_cast<size_t>(indices[static_cast<size_t>(i)])].name;
      const std::string& b = skeleton.dofs()[static_cast<size_t>(indices[static_cast<size_t>(j)])].name;
      double relative = kSize * kSize;
      if (without_side(a) == without_side(b)) relative += kBone * kBone;
      if (i == j) relative += kSide * kSide;
      covariance(i, j) = relative * length(i) * length(j);
    }
  }
  return covariance;
}

}  // namespace silpose
