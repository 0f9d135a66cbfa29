#include "silpose/body/point_motion.h"

namespace silpose {

PointMotion::PointMotion(const Skeleton& skeleton, std::span<const double> pose)
    : skeleton_(&skeleton),
      world_from_joint_(skeleton.forward_kinematics(pose)),
      axes_(skeleton.dof_axes(pose, world_from_joint_)) {}

Eigen::Matrix3Xd PointMotion::jacobian(int joint_idx, const Eigen::Vector3d& x) const {
  const auto joints = skeleton_->joints();
  const auto dofs = skeleton_->dofs();
  Eigen::Matrix3Xd jacobian = Eigen::Matrix3Xd::Zero(3, axes_.cols());
  for (int j = joint_idx; j >= 0; j = joints[static_cast<size_t>(j)].parent_idx) {
    const Eigen::Vector3d arm = x - world_from_joint_[static_cast<size_t>(j)].translation;
    for (const int d : joints[static_cast<size_t>(j)].dof_indices) {
      if (dofs[static_cast<size_t>(d)].is_translation) {
        jacobian.col(d) = axes_.col(d);
      } else {
        jacobian.col(d) = axes_.col(d).cross(arm);
      }
    }
  }
  return jacobian;
}

void PointMotion::add_derivative(int joint_idx, const Eigen::Vector3d& x, const Eigen::Vector3d& direction,
                                 Eigen::Ref<Eigen::VectorXd> derivative) const {
  const auto joints = skeleton_->joints();
  const auto dofs = skeleton_->dofs();
  for (int j = joint_idx; j >= 0; j = joints[static_cast<size_t>(j)].parent_idx) {
    const Eigen::Vector3d arm = x - world_from_joint_[static_cast<size_t>(j)].translation;
    const Eigen::Vector3d turning = arm.cross(direction);
    for (const int d : joints[static_cast<size_t>(j)].dof_indices) {
      derivative[d] += axes_.col(d).dot(dofs[static_cast<size_t>(d)].is_translation ? direction : turning);
    }
  }
}

}  // namespace silpose
