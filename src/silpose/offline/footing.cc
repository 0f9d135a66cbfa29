#include "silpose/offline/footing.h"

#include <algorithm>
#include <cmath>

namespace silpose {
namespace {

constexpr double kSlideDeviation = 0.016;  // [guess] metres in a second; its square grows with time
// [guess] From these on a point no longer rests on the floor; below, the less so the nearer it comes.
constexpr double kHighest = 0.05, kFastest = 0.5;  // metres, metres per second

// 1 at 0, 0 from 1 on. Source: Tukey's biweight.
double biweight(double ratio) {
  const double inside = std::max(0.0, 1 - ratio * ratio);
  return inside * inside;
}

}  // namespace

std::vector<FootContact> foot_contacts(std::span<const SkinPoint> points, const PointMotion& motion,
                                       const PointMotion& next, double dt_s) {
  std::vector<FootContact> holds;
  for (const SkinPoint& point : points) {  // a body that reaches through the floor is elsewhere
    if (motion.position(point.joint_idx, point.x_in_joint).y() < -kHighest) return holds;
  }
  size_t first_of_bone = 0;
  double sum = 0;
  const auto end_bone = [&] {  // the points of a bone share one foot_contact's weight
    for (; first_of_bone < holds.size(); ++first_of_bone) holds[first_of_bone].weight /= std::max(1.0, sum);
    sum = 0;
  };
  for (size_t i = 0; i < points.size(); ++i) {
    const SkinPoint& point = points[i];
    if (i > 0 && points[i - 1].joint_idx != point.joint_idx) end_bone();
    const Eigen::Vector3d x = motion.position(point.joint_idx, point.x_in_joint);
    const Eigen::Vector3d y = next.position(point.joint_idx, point.x_in_joint);
    const double height = std::max(std::abs(x.y()), std::abs(y.y()));
    const double speed = (y - x).norm() / dt_s;
    const double stands = biweight(height / kHighest) * biweight(speed / kFastest);
    if (stands <= 0) continue;
    holds.push_back({point, stands / (kSlideDeviation * kSlideDeviation * dt_s)});
    sum += stands;
  }
  end_bone();
  return holds;
}

FootholdEquations hold(std::span<const FootContact> holds, const PointMotion& motion, const PointMotion& next,
                       Eigen::Index num_dofs) {
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(num_dofs);
  const Eigen::MatrixXd empty = Eigen::MatrixXd::Zero(num_dofs, num_dofs);
  FootholdEquations at{none, none, empty, empty, empty, 0};
  Eigen::VectorXd row(num_dofs), row_next(num_dofs);
  for (const FootContact& foot_contact : holds) {
    const SkinPoint& point = foot_contact.point;
    const Eigen::Vector3d x = motion.position(point.joint_idx, point.x_in_joint);
    const Eigen::Vector3d y = next.position(point.joint_idx, point.x_in_joint);
    for (const Eigen::Vector3d& level : {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 0, 1)}) {
      const double slide = level.dot(y - x);
      row.setZero();
      row_next.setZero();
      motion.add_derivative(point.joint_idx, x, -level, row);
      next.add_derivative(point.joint_idx, y, level, row_next);
      at.cost += foot_contact.weight * slide * slide;
      at.gradient += foot_contact.weight * slide * row;
      at.gradient_next += foot_contact.weight * slide * row_next;
      at.hessian.noalias() += foot_contact.weight * row * row.transpose();
      at.hessian_next.noalias() += foot_contact.weight * row_next * row_next.transpose();
      at.across.noalias() += foot_contact.weight * row_next * row.transpose();
    }
  }
  return at;
}

}  // namespace silpose
