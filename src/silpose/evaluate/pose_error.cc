#include "silpose/evaluate/pose_error.h"

#include <Eigen/Geometry>
#include <cmath>

#include "silpose/base/check.h"

namespace silpose {
namespace {

void check_sizes(const Skeleton& skeleton, std::span<const double> pose, std::span<const double> truth) {
  const auto num_dofs = static_cast<size_t>(skeleton.num_dofs());
  check(pose.size() == num_dofs && truth.size() == num_dofs, "poses of {} and {} values for {} DOF", pose.size(),
        truth.size(), num_dofs);
}

// Calls visit(|difference in degrees|) for each rotational DOF.
template <class Visit>
void for_each_angle(const Skeleton& skeleton, std::span<const double> pose, std::span<const double> truth,
                    Visit visit) {
  check_sizes(skeleton, pose, truth);
  for (size_t d = 0; d < pose.size(); ++d) {
    if (!skeleton.dofs()[d].is_translation) visit(std::abs(to_degrees(wrap_angle(pose[d] - truth[d]))));
  }
}

bool has_extent(const Eigen::Matrix3Xd& points) {
  return (points.colwise() - points.rowwise().mean()).squaredNorm() > 1e-12;
}

}  // namespace

double pose_error_npsu(const Skeleton& skeleton, std::span<const double> pose, std::span<const double> truth) {
  check_sizes(skeleton, pose, truth);
  const std::vector<double> a = skeleton.normalise(pose), b = skeleton.normalise(truth);
  double sum = 0;
  for (size_t d = 0; d < a.size(); ++d) {
    double difference = a[d] - b[d];
    if (skeleton.dofs()[d].is_periodic) difference -= std::round(difference);  // limits are one turn apart
    sum += difference * difference;
  }
  return std::sqrt(sum);
}

double pose_error_deg(const Skeleton& skeleton, std::span<const double> pose, std::span<const double> truth) {
  double sum = 0;
  for_each_angle(skeleton, pose, truth, [&](double degrees) { sum += degrees * degrees; });
  return std::sqrt(sum);
}

double angle_error_deg(const Skeleton& skeleton, std::span<const double> pose, std::span<const double> truth) {
  double sum = 0;
  int count = 0;
  for_each_angle(skeleton, pose, truth, [&](double degrees) { sum += degrees, ++count; });
  return count > 0 ? sum / count : 0;
}

double mean_distance(const Eigen::MatrixXd& points, const Eigen::MatrixXd& truth) {
  check(points.cols() > 0 && points.cols() == truth.cols() && points.rows() == truth.rows(),
        "mean_distance of {} and {} points", points.cols(), truth.cols());
  return (points - truth).colwise().norm().mean();
}

std::optional<double> aligned_distance(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& truth) {
  check(points.cols() == truth.cols(), "aligned_distance of {} and {} points", points.cols(), truth.cols());
  if (points.cols() < 3 || !has_extent(points) || !has_extent(truth)) return std::nullopt;
  const Eigen::Matrix4d truth_from_points = Eigen::umeyama(points, truth, true);
  return mean_distance((truth_from_points * points.colwise().homogeneous()).topRows<3>(), truth);
}

std::optional<double> flexion_deg(const Eigen::Vector3d& above, const Eigen::Vector3d& joint,
                                  const Eigen::Vector3d& below) {
  const Eigen::Vector3d incoming = joint - above, outgoing = below - joint;
  if (incoming.isZero(0) || outgoing.isZero(0)) return std::nullopt;
  return to_degrees(std::atan2(incoming.cross(outgoing).norm(), incoming.dot(outgoing)));
}

}  // namespace silpose
