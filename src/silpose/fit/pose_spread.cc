#include "silpose/fit/pose_spread.h"

#include <algorithm>
#include <cmath>

#include "silpose/body/point_motion.h"

namespace silpose {

LandmarkVariances& LandmarkVariances::operator+=(const LandmarkVariances& other) {
  for (size_t l = 0; l < other.in_world.size(); ++l) {
    in_world[l] += other.in_world[l];
    about_root[l] += other.about_root[l];
  }
  return *this;
}

LandmarkVariances landmark_variances(const BodyModel& body, std::span<const double> pose,
                                     const Eigen::MatrixXd& covariance) {
  const PointMotion motion(body.skeleton, pose);
  const auto landmarks = landmark_positions(body, pose);
  const size_t num_joints = motion.world_from_joint().size();
  const Eigen::Matrix3Xd root = motion.jacobian(0, landmarks.front());
  const Eigen::Matrix3Xd root_covariance = root * covariance;
  const auto product = [](const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) -> Eigen::Vector3d {
    return a.cwiseProduct(b).rowwise().sum();
  };
  const Eigen::Vector3d of_root = product(root_covariance, root);
  LandmarkVariances variances;
  for (size_t l = 0; l < landmarks.size(); ++l) {
    const int joint = l < num_joints ? static_cast<int>(l) : body.end_points[l - num_joints].joint_idx;
    const Eigen::Matrix3Xd jacobian = motion.jacobian(joint, landmarks[l]);
    const Eigen::Vector3d own = product(jacobian * covariance, jacobian);
    variances.in_world.emplace_back(own.cwiseMax(0));
    variances.about_root.emplace_back((own - 2 * product(root_covariance, jacobian) + of_root).cwiseMax(0));
  }
  return variances;
}

PoseVariances& PoseVariances::operator+=(const PoseVariances& other) {
  for (size_t d = 0; d < other.dofs.size(); ++d) dofs[d] += other.dofs[d];
  landmarks += other.landmarks;
  return *this;
}

PoseVariances no_variances(size_t num_dofs, const BodyModel& body) {
  const size_t num_landmarks = static_cast<size_t>(body.skeleton.num_joints()) + body.end_points.size();
  const std::vector<Eigen::Vector3d> zero(num_landmarks, Eigen::Vector3d::Zero());
  return {std::vector<double>(num_dofs, 0.0), {zero, zero}};
}

PoseVariances pose_variances(const BodyModel& body, std::span<const double> pose, const Eigen::MatrixXd& covariance) {
  const Eigen::VectorXd dofs = covariance.diagonal();
  return {{dofs.begin(), dofs.end()}, landmark_variances(body, pose, covariance)};
}

PoseSpread spread_of(const PoseVariances& variances) {
  PoseSpread spread;
  for (const double variance : variances.dofs) spread.dofs.push_back(std::sqrt(std::max(variance, 0.0)));
  for (const Eigen::Vector3d& variance : variances.landmarks.in_world) {
    spread.landmarks.emplace_back(variance.cwiseSqrt());
  }
  for (const Eigen::Vector3d& variance : variances.landmarks.about_root) {
    spread.landmarks_about_root.emplace_back(variance.cwiseSqrt());
  }
  return spread;
}

PoseScatter::PoseScatter(const BodyModel& body, std::span<const double> centre)
    : body_(body), centre_(centre.begin(), centre.end()), landmarks_(landmark_positions(body, centre)) {}

void PoseScatter::add(double weight, std::span<const double> pose, PoseVariances& sum) const {
  add_with(weight, pose, nullptr, sum);
}

void PoseScatter::add(double weight, std::span<const double> pose, const Eigen::MatrixXd& covariance,
                      PoseVariances& sum) const {
  const PoseVariances own = pose_variances(body_, pose, covariance);
  add_with(weight, pose, &own, sum);
}

void PoseScatter::add_with(double weight, std::span<const double> pose, const PoseVariances* own,
                           PoseVariances& sum) const {
  for (size_t d = 0; d < centre_.size(); ++d) {
    double off = pose[d] - centre_[d];
    if (body_.skeleton.dofs()[d].is_periodic) off = wrap_angle(off);
    sum.dofs[d] += own != nullptr ? weight * (own->dofs[d] + off * off) : weight * off * off;
  }
  const auto landmarks = landmark_positions(body_, pose);
  const Eigen::Vector3d root_off = landmarks.front() - landmarks_.front();
  for (size_t l = 0; l < landmarks.size(); ++l) {
    const Eigen::Vector3d off = landmarks[l] - landmarks_[l];
    Eigen::Vector3d in_world = off.cwiseAbs2(), about_root = (off - root_off).cwiseAbs2();
    if (own != nullptr) {
      in_world += own->landmarks.in_world[l];
      about_root += own->landmarks.about_root[l];
    }
    sum.landmarks.in_world[l] += weight * in_world;
    sum.landmarks.about_root[l] += weight * about_root;
  }
}

}  // namespace silpose
