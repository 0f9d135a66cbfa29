// Gaussian components with log weights, whose state is a pose and its velocity: predicted at constant velocity,
// conditioned on a fitted pose, and summarised. What a mixture of extended Kalman filters is made of.
// Source: constant-velocity model with white-noise acceleration (references.bib: barshalom2001).
// Threads: values and pure functions.
#pragma once

#include <Eigen/Core>
#include <span>
#include <tuple>
#include <vector>

namespace silpose {

struct GaussianComponent {
  Eigen::VectorXd mean;        // [2 D] pose, then velocity per second
  Eigen::MatrixXd covariance;  // [2 D, 2 D]
  double log_weight = 0;

  [[nodiscard]] Eigen::Index num_dofs() const { return mean.size() / 2; }
  [[nodiscard]] auto pose() const { return mean.head(num_dofs()); }
  [[nodiscard]] auto pose_covariance() const { return covariance.topLeftCorner(num_dofs(), num_dofs()); }

  static auto members(auto& c) { return std::tie(c.mean, c.covariance, c.log_weight); }
};

// At rest at `pose` [D], with independent deviations of pose and velocity [D].
GaussianComponent component_at(std::span<const double> pose, std::span<const double> deviation,
                               std::span<const double> velocity_deviation);

// Moves a component on by dt seconds. `acceleration` [D]: deviation of the change of velocity over `interval` seconds,
// times the interval; its variance grows with time. Velocities fall by exp(-decay * dt). REQUIRES: dt >= 0.
void predict_constant_velocity(GaussianComponent& component, double dt, std::span<const double> acceleration,
                               double interval, double decay_per_s = 0);

// The component given that its pose was found to be Gaussian with this mean [D] and information [D, D] (which counts
// the component's own, as a posterior does): velocities follow by their covariance with the pose.
void condition_on_pose(GaussianComponent& component, const Eigen::VectorXd& pose, const Eigen::MatrixXd& information);

// Brings the log weights to a sum of one.
void normalise_weights(std::span<GaussianComponent> components);

}  // namespace silpose
