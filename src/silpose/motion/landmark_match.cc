#include "silpose/motion/landmark_match.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "silpose/body/point_motion.h"

namespace silpose {
namespace {

// Of the body's height in the picture: networks and rigs do not mean quite the same by a joint.
constexpr double kDeviation = 0.03;
constexpr double kFreedom = 4;  // degrees of Student's t
constexpr double kLeastVisible = 0.5;
constexpr double kBehind = 50;  // squared deviations of what is behind the camera

std::optional<std::pair<int, Eigen::Vector3d>> find_point(const BodyModel& body, const std::string& name) {
  if (const std::optional<int> joint = body.skeleton.find_joint(name)) return {{*joint, Eigen::Vector3d::Zero()}};
  for (const BodyModel::EndPoint& end : body.end_points) {
    if (end.name == name) return {{end.joint_idx, end.offset_in_joint}};
  }
  return std::nullopt;
}

}  // namespace

LandmarkMatch::LandmarkMatch(const BodyModel& body, const PinholeCamera& camera, const Observation& observation)
    : body_(&body), camera_(camera) {
  // An upright body covers about a tenth of its height squared, in most poses.
  const double height_px = std::sqrt(10 * static_cast<double>(observation.mask.count()));
  deviation_px_ = std::max(1.0, kDeviation * height_px);
  for (const SeenLandmark& seen : observation.landmarks) {
    if (!(seen.visibility >= kLeastVisible)) continue;
    if (!(seen.x >= 0 && seen.x < camera.width && seen.y >= 0 && seen.y < camera.height)) continue;
    const auto point = find_point(body, seen.name);
    if (point) points_.push_back({point->first, point->second, {seen.x, seen.y}, seen.visibility});
  }
}

double LandmarkMatch::cost_of(const Point& point, double squared) {
  return point.weight * (kFreedom + 2) * std::log1p(squared / kFreedom);
}

double LandmarkMatch::cost(std::span<const double> pose) const {
  const std::vector<Rigid3> world_from_joint = body_->skeleton.forward_kinematics(pose);
  double sum = 0;
  for (const Point& point : points_) {
    const auto pixel = camera_.project(world_from_joint[static_cast<size_t>(point.joint_idx)] * point.x_in_joint);
    const double squared = pixel ? (*pixel - point.pixel).squaredNorm() / (deviation_px_ * deviation_px_) : kBehind;
    sum += cost_of(point, squared);
  }
  return sum;
}

double LandmarkMatch::add(std::span<const double> pose, Eigen::VectorXd& gradient, Eigen::MatrixXd& hessian) const {
  const PointMotion motion(body_->skeleton, pose);
  double sum = 0;
  for (const Point& point : points_) {
    const Eigen::Vector3d x = motion.position(point.joint_idx, point.x_in_joint);
    const std::optional<Eigen::Vector2d> pixel = camera_.project(x);
    if (!pixel) {
      sum += cost_of(point, kBehind);
      continue;
    }
    const Eigen::Vector2d off = (*pixel - point.pixel) / deviation_px_;
    const double squared = off.squaredNorm();
    sum += cost_of(point, squared);
    const double weight = point.weight * (kFreedom + 2) / (kFreedom + squared);
    const Eigen::MatrixXd J = camera_.project_jacobian(x) * motion.jacobian(point.joint_idx, x) / deviation_px_;
    gradient += weight * J.transpose() * off;
    hessian += weight * J.transpose() * J;
  }
  return sum;
}

}  // namespace silpose
