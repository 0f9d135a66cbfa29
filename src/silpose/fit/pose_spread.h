// How far a pose may be from the truth: variances and standard deviations of its DOFs and landmarks, and the scatter of
// weighted poses about one.
// Threads: functions without state; PoseScatter is constant after construction.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "silpose/body/body_model.h"

namespace silpose {

// Variances of each landmark's coordinates [J + E], m^2, along the axes of the world: of its place, and of that place
// relative to the root joint.
struct LandmarkVariances {
  std::vector<Eigen::Vector3d> in_world, about_root;
  LandmarkVariances& operator+=(const LandmarkVariances& other);  // of an independent error
};

// Of a pose [D] whose covariance is [D, D], to first order.
LandmarkVariances landmark_variances(const BodyModel& body, std::span<const double> pose,
                                     const Eigen::MatrixXd& covariance);

// Variances about a pose.
struct PoseVariances {
  std::vector<double> dofs;  // [D] radians^2, metres^2
  LandmarkVariances landmarks;
  PoseVariances& operator+=(const PoseVariances& other);  // of an independent error
};

// Zeros, for `num_dofs` DOFs and the body's landmarks.
PoseVariances no_variances(size_t num_dofs, const BodyModel& body);

// Of a pose [D] whose covariance is [D, D], to first order.
PoseVariances pose_variances(const BodyModel& body, std::span<const double> pose, const Eigen::MatrixXd& covariance);

// Standard deviations about a pose.
struct PoseSpread {
  std::vector<double> dofs;                           // [D] radians, metres
  std::vector<Eigen::Vector3d> landmarks;             // [J + E] metres, as body's landmark_positions
  std::vector<Eigen::Vector3d> landmarks_about_root;  // [J + E] of their places relative to the root joint
};

// The square roots. A variance of a DOF that rounding left below 0 counts as 0.
PoseSpread spread_of(const PoseVariances& variances);

// The scatter of weighted poses about a centre: squared offsets of DOFs, which are taken the short way round where the
// DOF is periodic, and of landmarks.
class PoseScatter {
 public:
  // `centre` is a pose [D]. The body must outlive this.
  PoseScatter(const BodyModel& body, std::span<const double> centre);

  // Adds a pose [D] to variances of as many DOFs and landmarks as the body has.
  void add(double weight, std::span<const double> pose, PoseVariances& sum) const;
  // Adds one that has a covariance [D, D] of its own.
  void add(double weight, std::span<const double> pose, const Eigen::MatrixXd& covariance, PoseVariances& sum) const;

 private:
  void add_with(double weight, std::span<const double> pose, const PoseVariances* own, PoseVariances& sum) const;

  const BodyModel& body_;
  std::vector<double> centre_;              // [D]
  std::vector<Eigen::Vector3d> landmarks_;  // [J + E] of the centre
};

}  // namespace silpose
