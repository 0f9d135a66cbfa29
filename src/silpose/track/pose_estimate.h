// The one pose that represents a weighted particle set.
// Threads: functions without state.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "silpose/body/body_model.h"
#include "silpose/filter/particle_set.h"
#include "silpose/track/tracker_options.h"

namespace silpose {

// DOF that wrap.
std::vector<int> periodic_dofs(const Skeleton& skeleton);

// [D] The weighted mean, the best particle, or the mean of the cluster about it, inside the limits. `scale` [>= D] is
// what counts as far in each DOF, for the cluster. REQUIRES: particles whose first D columns are poses.
std::vector<double> pose_estimate(const Skeleton& skeleton, const ParticleSet& particles, Estimate kind,
                                  std::span<const double> scale);

// Variances of each landmark's coordinates [J + E], m^2, along the axes of the world: of its place, and of that place
// relative to the root joint.
struct LandmarkVariances {
  std::vector<Eigen::Vector3d> in_world, about_root;
  LandmarkVariances& operator+=(const LandmarkVariances& other);  // of an independent error
};

// Of `count` landmarks, all of them 0.
LandmarkVariances no_landmark_variances(size_t count);

// Of a pose [D] whose covariance is [D, D], to first order.
LandmarkVariances landmark_variances(const BodyModel& body, std::span<const double> pose,
                                     const Eigen::MatrixXd& covariance);

}  // namespace silpose
