#include "silpose/body/skin_derivative.h"

#include <algorithm>

#include "silpose/base/check.h"

namespace silpose {

SkinDerivative::SkinDerivative(const BodyModel& body)
    : body_(&body),
      world_from_joint_(body.skeleton.joints().size()),
      world_from_rest_(body.skeleton.joints().size()),
      centres_(body.skeleton.joints().size()),
      axes_(body.skeleton.dofs().size()),
      moments_(body.skeleton.joints().size(), Eigen::Vector3f::Zero()),
      directions_(body.skeleton.joints().size(), Eigen::Vector3f::Zero()) {
  for (const Joint& joint : body.skeleton.joints()) parents_.push_back(joint.parent_idx);
}

void SkinDerivative::set_pose(std::span<const double> pose) {
  const Skeleton& skeleton = body_->skeleton;
  skeleton.forward_kinematics(pose, world_from_joint_);
  const Eigen::Matrix3Xd axes = skeleton.dof_axes(pose, world_from_joint_);
  for (size_t d = 0; d < axes_.size(); ++d) axes_[d] = axes.col(static_cast<Eigen::Index>(d)).cast<float>();
  for (size_t j = 0; j < parents_.size(); ++j) {
    const Rigid3 world_from_rest = world_from_joint_[j] * body_->joint_from_rest[j];
    world_from_rest_[j] << world_from_rest.rotation.cast<float>(), world_from_rest.translation.cast<float>();
    centres_[j] = world_from_joint_[j].translation.cast<float>();
  }
  std::ranges::fill(moments_, Eigen::Vector3f::Zero());
  std::ranges::fill(directions_, Eigen::Vector3f::Zero());
  deepest_ = -1;
}

Eigen::Vector3f SkinDerivative::position(uint32_t vertex) const {
  Eigen::Vector3f x = Eigen::Vector3f::Zero();
  const Eigen::Vector4f rest = body_->rest.vertices[vertex].homogeneous();
  for (uint32_t i = body_->skin.row_start[vertex]; i < body_->skin.row_start[vertex + 1]; ++i) {
    x += body_->skin.weight[i] * (world_from_rest_[body_->skin.joint_idx[i]] * rest);
  }
  return x;
}

void SkinDerivative::add(uint32_t vertex, const Eigen::Vector3f& direction) {
  const Eigen::Vector4f rest = body_->rest.vertices[vertex].homogeneous();
  for (uint32_t i = body_->skin.row_start[vertex]; i < body_->skin.row_start[vertex + 1]; ++i) {
    const uint16_t j = body_->skin.joint_idx[i];
    const Eigen::Vector3f g = body_->skin.weight[i] * direction;
    moments_[j] += Eigen::Vector3f(world_from_rest_[j] * rest).cross(g);
    directions_[j] += g;
    deepest_ = std::max(deepest_, static_cast<int>(j));
  }
}

void SkinDerivative::take(std::span<float> derivative) {
  check(derivative.size() == axes_.size(), "SkinDerivative: room for {} of {} DOF", derivative.size(), axes_.size());
  std::ranges::fill(derivative, 0.0f);
  const auto joints = body_->skeleton.joints();
  const auto dofs = body_->skeleton.dofs();
  for (int j = deepest_; j >= 0; --j) {
    Eigen::Vector3f& moment = moments_[static_cast<size_t>(j)];
    Eigen::Vector3f& direction = directions_[static_cast<size_t>(j)];
    const Eigen::Vector3f about_centre = moment - centres_[static_cast<size_t>(j)].cross(direction);
    for (const int d : joints[static_cast<size_t>(j)].dof_indices) {
      derivative[static_cast<size_t>(d)] =
          axes_[static_cast<size_t>(d)].dot(dofs[static_cast<size_t>(d)].is_translation ? direction : about_centre);
    }
    const int parent = parents_[static_cast<size_t>(j)];
    if (parent >= 0) {
      moments_[static_cast<size_t>(parent)] += moment;
      directions_[static_cast<size_t>(parent)] += direction;
    }
    moment.setZero();
    direction.setZero();
  }
  deepest_ = -1;
}

}  // namespace silpose
