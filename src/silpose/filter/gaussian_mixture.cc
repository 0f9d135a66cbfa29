#include "silpose/filter/gaussian_mixture.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "silpose/base/check.h"
#include "silpose/filter/log_weights.h"

namespace silpose {

GaussianComponent component_at(std::span<const double> pose, std::span<const double> deviation,
                               std::span<const double> velocity_deviation) {
  check(deviation.size() == pose.size() && velocity_deviation.size() == pose.size(),
        "component_at: {} values, {} and {} deviations", pose.size(), deviation.size(), velocity_deviation.size());
  const auto D = std::ssize(pose);
  GaussianComponent component{Eigen::VectorXd::Zero(2 * D), Eigen::MatrixXd::Zero(2 * D, 2 * D), 0};
  for (Eigen::Index d = 0; d < D; ++d) {
    const auto i = static_cast<size_t>(d);
    component.mean[d] = pose[i];
    component.covariance(d, d) = deviation[i] * deviation[i];
    component.covariance(D + d, D + d) = velocity_deviation[i] * velocity_deviation[i];
  }
  return component;
}

void predict_constant_velocity(GaussianComponent& component, double dt, std::span<const double> acceleration,
                               double interval, double decay_per_s) {
  const Eigen::Index D = component.num_dofs();
  check(std::ssize(acceleration) == D && dt >= 0 && interval > 0,
        "predict_constant_velocity: {} accelerations for {} DOF, dt {}, interval {}", acceleration.size(), D, dt,
        interval);
  const double keep = std::exp(-decay_per_s * dt);
  const double moved = decay_per_s > 0 ? (1 - keep) / decay_per_s : dt;
  component.mean.head(D) += moved * component.mean.tail(D);
  component.mean.tail(D) *= keep;

  Eigen::MatrixXd& P = component.covariance;
  const Eigen::MatrixXd cross = P.topRightCorner(D, D), velocity = P.bottomRightCorner(D, D);
  P.topLeftCorner(D, D) += moved * (cross + cross.transpose()) + moved * moved * velocity;
  P.topRightCorner(D, D) = keep * (cross + moved * velocity);
  P.bottomLeftCorner(D, D) = P.topRightCorner(D, D).transpose();
  P.bottomRightCorner(D, D) = keep * keep * velocity;
  const double n = dt / interval;
  for (Eigen::Index d = 0; d < D; ++d) {
    const double a = acceleration[static_cast<size_t>(d)];
    const double q = a * a;  // per interval
    P(d, d) += q * n * n * n / 3;
    P(d, D + d) += q * n * n / 2 / interval;
    P(D + d, d) += q * n * n / 2 / interval;
    P(D + d, D + d) += q * n / (interval * interval);
  }
}

void condition_on_pose(GaussianComponent& component, const Eigen::VectorXd& pose, const Eigen::MatrixXd& information) {
  const Eigen::Index D = component.num_dofs();
  check(pose.size() == D && information.rows() == D && information.cols() == D,
        "condition_on_pose: pose of {}, information of {}x{} for {} DOF", pose.size(), information.rows(),
        information.cols(), D);
  Eigen::MatrixXd& P = component.covariance;
  // Velocity given pose is linear: gain = P_vx P_xx^-1; what is left of it does not depend on the pose.
  const Eigen::MatrixXd gain = P.topLeftCorner(D, D).ldlt().solve(P.topRightCorner(D, D)).transpose();
  const Eigen::MatrixXd left = P.bottomRightCorner(D, D) - gain * P.topRightCorner(D, D);
  component.mean.tail(D) += gain * (pose - component.mean.head(D));
  component.mean.head(D) = pose;
  const Eigen::MatrixXd posterior = information.ldlt().solve(Eigen::MatrixXd::Identity(D, D));
  P.topLeftCorner(D, D) = 0.5 * (posterior + posterior.transpose());
  P.bottomLeftCorner(D, D) = gain * P.topLeftCorner(D, D);
  P.topRightCorner(D, D) = P.bottomLeftCorner(D, D).transpose();
  const Eigen::MatrixXd velocity = left + P.bottomLeftCorner(D, D) * gain.transpose();
  P.bottomRightCorner(D, D) = 0.5 * (velocity + velocity.transpose());
}

void normalise_weights(std::span<GaussianComponent> components) {
  std::vector<double> log_weights;
  for (const GaussianComponent& component : components) log_weights.push_back(component.log_weight);
  normalise_log_weights(log_weights);
  for (size_t i = 0; i < components.size(); ++i) components[i].log_weight = log_weights[i];
}

}  // namespace silpose
