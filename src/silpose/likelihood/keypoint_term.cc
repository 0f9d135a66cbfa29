#include "silpose/likelihood/keypoint_term.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "silpose/base/check.h"
#include "silpose/body/point_motion.h"
#include "silpose/shape/keypoint_axes.h"

namespace silpose {
namespace {

using Eigen::Vector3d;

constexpr double kFreedom = 4;  // [guess] degrees of freedom of Student's t
// [guess] Standard deviation of a place, as a share of the body's height in the image. Networks and bodies define
// joints differently.
constexpr double kPlaceDeviation = 0.03;
constexpr double kLeastVisible = 0.5;  // [guess] keypoints of a lower visibility are left out
// [guess] Squared deviations that a point behind the camera counts as. 100 deviations are about the diagonal of the
// image for a body half as tall as it.
constexpr double kBehind = 1e4;
constexpr double kShortest_m = 0.05;  // [guess] a segment that the network sees shorter than this has no direction
constexpr size_t kFewestSeen = 6;     // [guess] keypoints that determine the pose of a whole body

// Cost of a residual of that many squared deviations, and its derivative.
double cost_of(double weight, double squared) { return weight * (kFreedom + 2) * std::log1p(squared / kFreedom); }
double slope_of(double weight, double squared) { return weight * (kFreedom + 2) / (kFreedom + squared); }

Vector3d position(const Keypoint3D& keypoint) { return {keypoint.x[0], keypoint.x[1], keypoint.x[2]}; }

}  // namespace

bool KeypointTerm::determines_pose() const { return num_seen_ >= kFewestSeen; }

KeypointTerm::KeypointTerm(const BodyModel& body, const PinholeCamera& camera, const Observation& observation,
                           const KeypointWeights& weights)
    : camera_(camera) {
  check(body.profile.silhouette_area > 0, "KeypointTerm: the area of the body's silhouettes is not known");
  const double height_px = std::sqrt(1 / body.profile.silhouette_area * static_cast<double>(observation.mask.count()));
  deviation_px_ = std::max(1.0, kPlaceDeviation * height_px);
  add_places(body, observation, weights.places);
  if (weights.directions > 0 && !observation.keypoints_3d.empty()) {
    add_directions(body, observation.keypoints_3d, weights.directions);
  }
}

std::optional<size_t> KeypointTerm::point_of(const BodyModel& body, std::string_view name) {
  Point point;
  // Rigs whose landmarks have the network's own names need not list them.
  if (const std::string_view own = body.profile.landmark_called(name, "keypoints"); !own.empty()) name = own;
  if (const std::optional<int> joint = body.skeleton.find_joint(name)) {
    point.joint_idx = *joint;
  } else {
    const auto end = std::ranges::find(body.end_points, name, &BodyModel::EndPoint::name);
    if (end == body.end_points.end()) return std::nullopt;
    point = {end->joint_idx, end->offset_in_joint};
  }
  for (size_t i = 0; i < points_.size(); ++i) {
    if (points_[i].joint_idx == point.joint_idx && points_[i].x_in_joint == point.x_in_joint) return i;
  }
  points_.push_back(point);
  return points_.size() - 1;
}

void KeypointTerm::add_places(const BodyModel& body, const Observation& observation, double weight) {
  for (const Keypoint2D& seen : observation.keypoints_2d) {
    if (!(seen.visibility >= kLeastVisible)) continue;
    if (!(seen.x >= 0 && seen.x < camera_.width && seen.y >= 0 && seen.y < camera_.height)) continue;
    const auto point = point_of(body, seen.name);
    if (!point) continue;
    ++num_seen_;
    if (weight > 0) places_.push_back({*point, {seen.x, seen.y}, weight * seen.visibility});
  }
}

void KeypointTerm::add_directions(const BodyModel& body, const Keypoints3D& keypoints, double weight) {
  ray_from_world_ = world_from_keypoints(camera_, keypoints).transpose();

  const auto add = [&](std::span<const std::string> from, std::span<const std::string> to, const DirectionError& error,
                       const Vector3d& bias) {
    Direction direction;
    Vector3d vector = Vector3d::Zero();
    double visibility = 1;
    for (const bool is_end : {false, true}) {
      const auto names = is_end ? to : from;
      for (const std::string& name : names) {
        const Keypoint3D* keypoint = keypoints.find(name);
        const std::optional<size_t> point = point_of(body, name);
        if (!keypoint || !point) return;
        const double factor = (is_end ? 1.0 : -1.0) / static_cast<double>(names.size());
        vector += factor * position(*keypoint);
        visibility = std::min(visibility, keypoint->visibility);
        direction.ends.push_back({*point, factor});
      }
    }
    if (!vector.allFinite() || !(vector.norm() >= kShortest_m) || !(visibility > 0)) return;
    direction.observed = (vector.normalized() - bias).normalized();
    direction.inverse_deviation = {1 / error.in_image, 1 / error.in_image, 1 / error.in_depth};
    direction.weight = weight * visibility;
    directions_.push_back(std::move(direction));
  };
  const std::string hips[] = {std::string(kHipKeypoints.right), std::string(kHipKeypoints.left)},
                    shoulders[] = {std::string(kShoulderKeypoints.right), std::string(kShoulderKeypoints.left)};
  const std::span all_hips(hips), all_shoulders(shoulders);
  add(all_hips, all_shoulders, kTrunkError, Vector3d::Zero());
  add(all_hips.first(1), all_hips.last(1), kHipsError, Vector3d::Zero());
  add(all_shoulders.first(1), all_shoulders.last(1), kShouldersError, Vector3d::Zero());
  // The subject's forward direction: normal to the line across hips and shoulders, and to the trunk.
  Vector3d forward = Vector3d::Zero();
  const Keypoint3D *right_hip = keypoints.find(hips[0]), *left_hip = keypoints.find(hips[1]),
                   *right_shoulder = keypoints.find(shoulders[0]), *left_shoulder = keypoints.find(shoulders[1]);
  if (right_hip && left_hip && right_shoulder && left_shoulder) {
    const Vector3d left =
        position(*left_hip) - position(*right_hip) + position(*left_shoulder) - position(*right_shoulder);
    const Vector3d up =
        position(*left_shoulder) + position(*right_shoulder) - position(*left_hip) - position(*right_hip);
    forward = left.cross(up).stableNormalized();
  }
  for (const std::string side : {"right_", "left_"}) {
    for (const LimbSegment& segment : kLimbSegments) {
      const std::string from = side + std::string(segment.from), to = side + std::string(segment.to);
      add(std::span(&from, 1), std::span(&to, 1), segment.error, segment.forward_bias * forward);
    }
  }
}

double KeypointTerm::cost(const Skeleton& skeleton, std::span<const double> pose) const {
  const std::vector<Rigid3> world_from_joint = skeleton.forward_kinematics(pose);
  std::vector<Vector3d> x;
  x.reserve(points_.size());
  for (const Point& point : points_) {
    x.push_back(world_from_joint[static_cast<size_t>(point.joint_idx)] * point.x_in_joint);
  }
  double sum = 0;
  for (const Place& place : places_) {
    const auto pixel = camera_.project(x[place.point]);
    sum +=
        cost_of(place.weight, pixel ? (*pixel - place.pixel).squaredNorm() / (deviation_px_ * deviation_px_) : kBehind);
  }
  for (const Direction& direction : directions_) {
    Vector3d vector = Vector3d::Zero();
    for (const End& end : direction.ends) vector += end.factor * x[end.point];
    const Vector3d off =
        direction.inverse_deviation.cwiseProduct(ray_from_world_ * vector.stableNormalized() - direction.observed);
    sum += cost_of(direction.weight, off.squaredNorm());
  }
  return sum;
}

double KeypointTerm::add(const Skeleton& skeleton, std::span<const double> pose, double trust,
                         Eigen::VectorXd& gradient, Eigen::MatrixXd& hessian) const {
  const PointMotion motion(skeleton, pose);
  std::vector<Vector3d> x;
  x.reserve(points_.size());
  for (const Point& point : points_) x.push_back(motion.position(point.joint_idx, point.x_in_joint));

  const auto most_rows = static_cast<Eigen::Index>(2 * places_.size() + 3 * directions_.size());
  Eigen::MatrixXd jacobian = Eigen::MatrixXd::Zero(gradient.size(), most_rows);  // transposed: one column per residual
  Eigen::VectorXd residual(most_rows);
  Eigen::Index row = 0;
  double sum = 0;
  for (const Place& place : places_) {
    const std::optional<Eigen::Vector2d> pixel = camera_.project(x[place.point]);
    if (!pixel) {
      sum += cost_of(place.weight, kBehind);
      continue;
    }
    const Eigen::Vector2d off = (*pixel - place.pixel) / deviation_px_;
    sum += cost_of(place.weight, off.squaredNorm());
    const double root = std::sqrt(slope_of(place.weight, off.squaredNorm()));
    const Eigen::Matrix<double, 2, 3> by_x = root / deviation_px_ * camera_.project_jacobian(x[place.point]);
    for (Eigen::Index i = 0; i < 2; ++i, ++row) {
      residual[row] = root * off[i];
      motion.add_derivative(points_[place.point].joint_idx, x[place.point], by_x.row(i).transpose(), jacobian.col(row));
    }
  }
  for (const Direction& direction : directions_) {
    Vector3d vector = Vector3d::Zero();
    for (const End& end : direction.ends) vector += end.factor * x[end.point];
    const double length = vector.norm();
    const Vector3d unit = vector.stableNormalized();
    const Vector3d off = direction.inverse_deviation.cwiseProduct(ray_from_world_ * unit - direction.observed);
    sum += cost_of(direction.weight, off.squaredNorm());
    if (length <= 0) continue;
    const double root = std::sqrt(slope_of(direction.weight, off.squaredNorm()));
    const Eigen::Matrix3d by_vector = root / length * direction.inverse_deviation.asDiagonal() * ray_from_world_ *
                                      (Eigen::Matrix3d::Identity() - unit * unit.transpose());
    for (Eigen::Index i = 0; i < 3; ++i, ++row) {
      residual[row] = root * off[i];
      for (const End& end : direction.ends) {
        motion.add_derivative(points_[end.point].joint_idx, x[end.point], end.factor * by_vector.row(i).transpose(),
                              jacobian.col(row));
      }
    }
  }
  gradient.noalias() += trust * jacobian.leftCols(row) * residual.head(row);
  Eigen::MatrixXd lower = Eigen::MatrixXd::Zero(hessian.rows(), hessian.cols());
  lower.selfadjointView<Eigen::Lower>().rankUpdate(jacobian.leftCols(row), trust);
  hessian += lower.selfadjointView<Eigen::Lower>();
  return trust * sum;
}

std::shared_ptr<const KeypointTerm> make_keypoint_term(const BodyModel& body, const PinholeCamera& camera,
                                                       const Observation& observation, EvidenceKind kind, bool places) {
  if (kind == EvidenceKind::kSilhouette) return nullptr;
  KeypointWeights weights;
  if (kind == EvidenceKind::kKeypoints) weights.places = 1;
  if (!places) weights.places = 0;
  auto term = std::make_shared<const KeypointTerm>(body, camera, observation, weights);
  return term->determines_pose() ? term : nullptr;
}

}  // namespace silpose
