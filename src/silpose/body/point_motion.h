// PointMotion: how points that are fixed to joints move with the pose.
// Threads: a value; const functions are safe.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "silpose/body/skeleton.h"

namespace silpose {

class PointMotion {
 public:
  PointMotion(const Skeleton& skeleton, std::span<const double> pose)  // keeps a reference to the skeleton
      : skeleton_(&skeleton),
        world_from_joint_(skeleton.forward_kinematics(pose)),
        axes_(skeleton.dof_axes(pose, world_from_joint_)) {}

  [[nodiscard]] Eigen::Vector3d position(int joint_idx, const Eigen::Vector3d& x_in_joint) const {
    return world_from_joint_[static_cast<size_t>(joint_idx)] * x_in_joint;
  }

  // derivative [D] += d (direction . x) / d pose, for a point at `x` in the world.
  void add_derivative(int joint_idx, const Eigen::Vector3d& x, const Eigen::Vector3d& direction,
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

 private:
  const Skeleton* skeleton_;
  std::vector<Rigid3> world_from_joint_;  // [J]
  Eigen::Matrix3Xd axes_;                 // [3, D]
};

}  // namespace silpose
