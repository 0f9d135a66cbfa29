#include "silpose/fit/limb_reach.h"

#include <Eigen/Cholesky>
#include <algorithm>

#include "silpose/body/point_motion.h"

namespace silpose {

std::vector<LimbPoint> limb_points(const BodyModel& body, const Limb& limb) {
  std::vector<LimbPoint> points;
  for (const int j : limb.joints) {
    const Joint& joint = body.skeleton.joints()[static_cast<size_t>(j)];
    if (points.empty() && joint.dof_indices.empty()) continue;
    points.push_back({j, Eigen::Vector3d::Zero()});
  }
  if (points.empty()) return points;
  const int last_joint = limb.joints.back();
  const auto end_point = std::ranges::find(body.end_points, last_joint, &BodyModel::EndPoint::joint_idx);
  const auto joints = body.skeleton.joints();
  const auto next = std::ranges::find(joints, last_joint, &Joint::parent_idx);
  if (end_point != body.end_points.end()) {
    points.push_back({last_joint, end_point->offset_in_joint});
  } else if (next != joints.end()) {
    points.push_back({last_joint, next->offset_in_parent});
  }
  return points;
}

std::vector<Eigen::Vector3d> positions(const Skeleton& skeleton, std::span<const LimbPoint> points,
                                       std::span<const double> pose) {
  const auto world_from_joint = skeleton.forward_kinematics(pose);
  std::vector<Eigen::Vector3d> x;
  x.reserve(points.size());
  for (const LimbPoint& point : points) {
    x.push_back(world_from_joint[static_cast<size_t>(point.joint_idx)] * point.offset);
  }
  return x;
}

double reach_for(const Skeleton& skeleton, const Limb& limb, std::span<const LimbPoint> points,
                 std::span<const Eigen::Vector3d> targets, const Eigen::Matrix3d& seen, std::vector<double>& pose) {
  // [guess] So are the 5 mm at which a point is reached, and the 0.7 rad that a step turns at most, below.
  constexpr int kIterations = 15, kLeastIterations = 3;
  constexpr double kStale = 0.98;  // of the distance before: what is out of reach gets no nearer
  constexpr double kHold = 1e-4;   // m^2 / rad^2: keeps twists that no point shows where they are
  const auto num_dofs = static_cast<Eigen::Index>(limb.dofs.size());
  double largest = 0;
  for (int iteration = 0; iteration <= kIterations; ++iteration) {
    const PointMotion motion(skeleton, pose);
    const double before = largest;
    Eigen::MatrixXd normal = kHold * Eigen::MatrixXd::Identity(num_dofs, num_dofs);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(num_dofs);
    largest = 0;
    for (size_t i = 1; i < points.size(); ++i) {
      const Eigen::Vector3d x = motion.position(points[i].joint_idx, points[i].offset);
      const Eigen::Vector3d off = seen * (targets[i] - x);
      largest = std::max(largest, off.norm());
      const Eigen::Matrix3Xd all = motion.jacobian(points[i].joint_idx, x);
      const Eigen::Matrix3Xd jacobian = seen * all(Eigen::all, limb.dofs);
      normal += jacobian.transpose() * jacobian;
      right += jacobian.transpose() * off;
    }
    if (iteration == kIterations || largest < 0.005) break;
    if (iteration > kLeastIterations && largest > kStale * before) break;
    Eigen::VectorXd step = normal.ldlt().solve(right);
    const double longest = step.cwiseAbs().maxCoeff();
    if (longest > 0.7) step *= 0.7 / longest;
    for (Eigen::Index i = 0; i < num_dofs; ++i) pose[static_cast<size_t>(limb.dofs[static_cast<size_t>(i)])] += step[i];
    skeleton.clamp(pose);
  }
  return largest;
}

}  // namespace silpose
