// PointMotion: how points that are fixed to joints move with the pose: positions and derivatives by it, of any number
// of points at the cost of one forward kinematics. Threads: a value; const functions are safe.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "silpose/body/skeleton.h"

namespace silpose {

class PointMotion {
 public:
  // At a pose [D]; keeps a reference to the skeleton. Errors: throws std::invalid_argument for a pose of another size.
  PointMotion(const Skeleton& skeleton, std::span<const double> pose);

  // [J] where each joint's coordinate frame is.
  [[nodiscard]] std::span<const Rigid3> world_from_joint() const { return world_from_joint_; }

  // In world coordinates, metres.
  [[nodiscard]] Eigen::Vector3d position(int joint_idx, const Eigen::Vector3d& x_in_joint) const {
    return world_from_joint_[static_cast<size_t>(joint_idx)] * x_in_joint;
  }

  // d x / d pose [3, D] of a point at `x` in the world: metres per radian, or per metre.
  [[nodiscard]] Eigen::Matrix3Xd jacobian(int joint_idx, const Eigen::Vector3d& x) const;

  // derivative [D] += d (direction . x) / d pose, for a point at `x` in the world.
  void add_derivative(int joint_idx, const Eigen::Vector3d& x, const Eigen::Vector3d& direction,
                      Eigen::Ref<Eigen::VectorXd> derivative) const;

 private:
  const Skeleton* skeleton_;
  std::vector<Rigid3> world_from_joint_;  // [J]
  Eigen::Matrix3Xd axes_;                 // [3, D]
};

}  // namespace silpose
