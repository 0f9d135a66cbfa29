#include "silpose/fit/pose_prior.h"

#include <algorithm>
#include <cmath>

#include "silpose/base/check.h"
#include "silpose/geometry/rigid3.h"

namespace silpose {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

// [guess] All of them. Student's t about rest itself is kept as it helps on degraded masks (docs/notebook/tracking.md).
constexpr double kLimitDeviation = 0.02;    // radians, or metres, beyond a limit that cost 1
constexpr double kRestFreedom = 2;          // degrees of freedom of Student's t
constexpr double kOverlapDeviation = 0.02;  // metres that two spheres overlap, beyond what they do at rest
constexpr double kYield = 0.02;             // metres that flesh gives way
constexpr double kNeighbours = 2;           // radii: along the bones; nearer spheres are of one fold of flesh
constexpr double kFloorDeviation = 0.02;    // metres below the floor
constexpr double kNoFloor = 0.2;            // metres below: the floor is not where it was assumed, and no longer pushes

double add_limits(const Skeleton& skeleton, const VectorXd& pose, VectorXd& gradient, MatrixXd& hessian) {
  constexpr double kLimit = 1 / (kLimitDeviation * kLimitDeviation);
  double cost = 0;
  for (Eigen::Index d = 0; d < pose.size(); ++d) {
    const Dof& dof = skeleton.dofs()[static_cast<size_t>(d)];
    if (!dof.has_limits()) continue;
    const double beyond = pose[d] - std::clamp(pose[d], dof.lower, dof.upper);
    if (beyond == 0) continue;
    cost += kLimit * beyond * beyond;
    gradient[d] += kLimit * beyond;
    hessian(d, d) += kLimit;
  }
  return cost;
}

// Student's t about rest: most poses are near it, and one that is not must not be pulled back.
double add_rest(const Skeleton& skeleton, std::span<const double> deviation, double weight, const VectorXd& pose,
                VectorXd& gradient, MatrixXd& hessian) {
  double cost = 0;
  for (Eigen::Index d = 0; d < pose.size(); ++d) {
    const double scale = deviation[static_cast<size_t>(d)] * std::sqrt(kRestFreedom);
    if (scale == 0) continue;
    const Dof& dof = skeleton.dofs()[static_cast<size_t>(d)];
    const double off = dof.is_periodic ? wrap_angle(pose[d]) : pose[d] - std::clamp(0.0, dof.lower, dof.upper);
    const double inverse = 1 / (scale * scale + off * off);
    const double information = weight * (kRestFreedom + 1) * inverse;
    cost -= weight * (kRestFreedom + 1) * std::log(scale * scale * inverse);
    gradient[d] += information * off;
    hessian(d, d) += information;
  }
  return cost;
}

// weight * residual^2, whose derivative is `row` [D].
double add_residual(double residual, double weight, const VectorXd& row, VectorXd& gradient, MatrixXd& hessian) {
  gradient += weight * residual * row;
  hessian.noalias() += (weight * row) * row.transpose();
  return weight * residual * residual;
}

// From centre to centre by way of the joints between them.
double distance_along_bones(const Skeleton& skeleton, const CollisionSphere& a, const CollisionSphere& b) {
  CollisionSphere ends[] = {a, b};
  double length = 0;
  while (ends[0].joint_idx != ends[1].joint_idx) {  // the one further down the tree goes up by a joint
    CollisionSphere& end = ends[0].joint_idx > ends[1].joint_idx ? ends[0] : ends[1];
    const Joint& joint = skeleton.joints()[static_cast<size_t>(end.joint_idx)];
    length += end.centre_in_joint.norm();
    end = {joint.parent_idx, joint.offset_in_parent, 0};
  }
  return length + (ends[0].centre_in_joint - ends[1].centre_in_joint).norm();
}

// [J] about all spheres of each bone.
std::vector<CollisionSphere> bounds_of(size_t num_joints, const std::vector<CollisionSphere>& spheres) {
  std::vector<CollisionSphere> bounds(num_joints, {0, Vector3d::Zero(), 0});
  std::vector<double> count(num_joints, 0);
  for (const CollisionSphere& sphere : spheres) {
    const auto j = static_cast<size_t>(sphere.joint_idx);
    bounds[j].centre_in_joint += (sphere.centre_in_joint - bounds[j].centre_in_joint) / ++count[j];
  }
  for (const CollisionSphere& sphere : spheres) {
    CollisionSphere& bound = bounds[static_cast<size_t>(sphere.joint_idx)];
    bound.radius = std::max(bound.radius, (sphere.centre_in_joint - bound.centre_in_joint).norm() + sphere.radius);
  }
  return bounds;
}

}  // namespace

PosePrior::PosePrior(std::shared_ptr<const BodyModel> body, bool floor) : body_(std::move(body)) {
  check(body_ != nullptr, "PosePrior: no body");
  check_profile(body_->profile, body_->skeleton);
  const Skeleton& skeleton = body_->skeleton;
  spheres_ = collision_spheres(*body_);
  bounds_ = bounds_of(skeleton.joints().size(), spheres_);

  const PointMotion hanging(skeleton, std::vector<double>(skeleton.dofs().size(), 0.0));
  if (floor) points_ = outermost_points(*body_);

  const auto distance_at_zero = [&](const CollisionSphere& a, const CollisionSphere& b) {
    return (hanging.position(a.joint_idx, a.centre_in_joint) - hanging.position(b.joint_idx, b.centre_in_joint)).norm();
  };
  const auto distance_at_rest = [&](const CollisionSphere& a, const CollisionSphere& b) {
    const auto in_rest = [&](const CollisionSphere& s) {
      return body_->joint_from_rest[static_cast<size_t>(s.joint_idx)].inverse() * s.centre_in_joint;
    };
    return (in_rest(a) - in_rest(b)).norm();
  };
  for (int i = 0; i < std::ssize(spheres_); ++i) {
    for (int j = 0; j < i; ++j) {
      const CollisionSphere &a = spheres_[static_cast<size_t>(j)], &b = spheres_[static_cast<size_t>(i)];
      if (distance_along_bones(skeleton, a, b) < kNeighbours * (a.radius + b.radius)) continue;
      const double nearest = std::min(distance_at_zero(a, b), distance_at_rest(a, b));
      const double reach = std::min(a.radius + b.radius, nearest) - kYield;
      if (reach <= 0) continue;
      const auto same = [&](const BonePair& pair) { return pair.a == a.joint_idx && pair.b == b.joint_idx; };
      auto pair = std::ranges::find_if(pairs_, same);
      if (pair == pairs_.end()) pair = pairs_.insert(pair, {a.joint_idx, b.joint_idx, {}});
      pair->spheres.push_back({j, i, reach});
    }
  }
}

// visit(a, b, x_a, x_b, overlap) for spheres that overlap by more than at rest.
template <typename Visit>
void PosePrior::for_each_overlap(const PointMotion& motion, const Visit& visit) const {
  std::vector<Vector3d> middles;
  for (size_t j = 0; j < bounds_.size(); ++j) {
    middles.push_back(motion.position(static_cast<int>(j), bounds_[j].centre_in_joint));
  }
  for (const BonePair& pair : pairs_) {
    const auto a = static_cast<size_t>(pair.a), b = static_cast<size_t>(pair.b);
    const double bound = bounds_[a].radius + bounds_[b].radius;
    if ((middles[a] - middles[b]).squaredNorm() >= bound * bound) continue;
    for (const SpherePair& touch : pair.spheres) {
      const CollisionSphere &one = spheres_[static_cast<size_t>(touch.a)],
                            &other = spheres_[static_cast<size_t>(touch.b)];
      const Vector3d x = motion.position(one.joint_idx, one.centre_in_joint);
      const Vector3d y = motion.position(other.joint_idx, other.centre_in_joint);
      const double squared = (x - y).squaredNorm();
      if (squared < touch.reach * touch.reach) visit(one, other, x, y, touch.reach - std::sqrt(squared));
    }
  }
}

double PosePrior::add_penetration(const PointMotion& motion, VectorXd& gradient, MatrixXd& hessian) const {
  constexpr double kWeight = 1 / (kOverlapDeviation * kOverlapDeviation);
  double cost = 0;
  VectorXd row(gradient.size());
  for_each_overlap(motion, [&](const CollisionSphere& a, const CollisionSphere& b, const Vector3d& x, const Vector3d& y,
                               double overlap) {
    const Vector3d closer = (y - x).stableNormalized();  // moving a along it makes the overlap larger
    row.setZero();
    motion.add_derivative(a.joint_idx, x, closer, row);
    motion.add_derivative(b.joint_idx, y, -closer, row);
    cost += add_residual(overlap, kWeight, row, gradient, hessian);
  });
  return cost;
}

double PosePrior::add_floor(const PointMotion& motion, VectorXd& gradient, MatrixXd& hessian) const {
  constexpr double kWeight = 1 / (kFloorDeviation * kFloorDeviation);
  std::vector<Vector3d> positions;
  positions.reserve(points_.size());
  for (const SkinPoint& point : points_) {
    positions.push_back(motion.position(point.joint_idx, point.x_in_joint));
    if (positions.back().y() < -kNoFloor) return 0;
  }
  double cost = 0;
  VectorXd row(gradient.size());
  for (size_t i = 0; i < points_.size(); ++i) {
    const Vector3d& x = positions[i];
    if (x.y() >= 0) continue;
    const double inside = 1 - x.y() * x.y() / (kNoFloor * kNoFloor);  // Tukey's biweight
    cost += kWeight * kNoFloor * kNoFloor / 3 * (1 - inside * inside * inside);
    row.setZero();
    motion.add_derivative(points_[i].joint_idx, x, Vector3d::UnitY(), row);
    add_residual(x.y(), kWeight * inside * inside, row, gradient, hessian);
  }
  return cost;
}

double PosePrior::add(const VectorXd& pose, const RestPull& rest, VectorXd& gradient, MatrixXd& hessian) const {
  const PointMotion motion(body_->skeleton, {pose.data(), static_cast<size_t>(pose.size())});
  return add_limits(body_->skeleton, pose, gradient, hessian) +
         (rest.weight > 0
              ? add_rest(body_->skeleton, rest.directions_seen ? body_->profile.rest_if_seen : body_->profile.rest,
                         rest.weight, pose, gradient, hessian)
              : 0) +
         add_penetration(motion, gradient, hessian) + add_floor(motion, gradient, hessian);
}

}  // namespace silpose
