#include "silpose/track/adaptive_filter.h"

#include <algorithm>
#include <cmath>

#include "silpose/base/check.h"
#include "silpose/base/clock.h"
#include "silpose/filter/adaptive_search.h"
#include "silpose/track/pose_estimate.h"

namespace silpose {
namespace {

// Share of a frame's apparent velocity that enters the running one; the same share of it is lost at every step, so that
// a tracker that sees nothing soon stands still.
constexpr double kVelocityGain = 0.5;
// A start is known to within the noise of this long.
constexpr double kStartInterval_s = 0.15;

double difference(const Dof& dof, double to, double from) {
  return dof.is_periodic ? wrap_angle(to - from) : to - from;
}

}  // namespace

AdaptiveFilter::AdaptiveFilter(const TrackerOptions& options,
                               std::vector<std::shared_ptr<const BatchRenderer>> renderers)
    : options_(options),
      likelihood_(std::move(renderers), {.sharpness = *options.sharpness}),
      diffusion_(make_motion_model("diffusion", options.body->skeleton, {.sigma_deg = *options.sigma_deg}).value()) {
  for (const Dof& dof : options.body->skeleton.dofs()) free_dofs_.push_back(!options.root_fixed || dof.joint_idx != 0);
}

void AdaptiveFilter::start(std::span<const StartingPose> starts) {
  check(!starts.empty(), "AdaptiveFilter: no starting pose");
  pose_ = starts.front().pose;
  velocity_.assign(pose_.size(), 0);
  unseen_s_ = kStartInterval_s;
  started_ = false;
}

FilterReport AdaptiveFilter::step(std::span<const Observation> observations, double dt_s, StepSeconds& seconds) {
  check(!pose_.empty(), "AdaptiveFilter: step before start");
  const Evidence evidence = likelihood_.prepare(observations);
  FilterReport report;
  std::vector<double> predicted = pose_;
  if (*options_.motion != "diffusion") {
    for (size_t d = 0; d < predicted.size(); ++d) predicted[d] += velocity_[d] * dt_s;
    options_.body->skeleton.clamp(predicted);
  }
  unseen_s_ += dt_s;
  particles_ = search(evidence, predicted, unseen_s_, seconds, report);
  const auto pose = pose_estimate(options_.body->skeleton, particles_, *options_.estimate, diffusion_->deviation());
  if (started_) update_velocity(pose, unseen_s_);
  started_ = true;
  pose_ = pose;
  unseen_s_ = 0;
  return report;
}

FilterReport AdaptiveFilter::coast(double dt_s) {
  check(!pose_.empty(), "AdaptiveFilter: coast before start");
  unseen_s_ += dt_s;
  for (double& velocity : velocity_) velocity *= 1 - kVelocityGain;
  const StateBatch before = particles_.states;
  diffusion_->propagate(particles_.states, dt_s, options_.seed, stream_of(step_++));
  for (size_t d = 0; d < free_dofs_.size(); ++d) {
    const auto column = static_cast<Eigen::Index>(d);
    if (!free_dofs_[d]) particles_.states.col(column) = before.col(column);
  }
  return {.effective_sample_size = effective_sample_size(particles_.weights())};
}

std::vector<double> AdaptiveFilter::estimate() const { return pose_; }

ParticleSet AdaptiveFilter::search(const Evidence& evidence, const std::vector<double>& mean, double interval_s,
                                   StepSeconds& seconds, FilterReport& report) {
  const Stopwatch whole;
  double weighing = 0;
  GaussianPrior prior{mean, {diffusion_->deviation().begin(), diffusion_->deviation().end()}};
  for (size_t d = 0; d < free_dofs_.size(); ++d) {
    prior.deviation[d] *= free_dofs_[d] ? std::sqrt(interval_s / kNoiseInterval_s) : 0;
  }
  const AdaptiveSearchOptions search_options{
      .num_particles = *options_.num_particles, .num_layers = *options_.num_layers, .seed = options_.seed};
  ParticleSet particles = adaptive_search(
      prior, search_options, step_++, [&](std::span<double> pose) { options_.body->skeleton.clamp(pose); },
      [&](const StateBatch& states, std::span<double> out) {
        const Stopwatch stopwatch;
        likelihood_.log_likelihood(evidence, states, out);
        weighing += stopwatch.seconds();
      },
      report);
  seconds.likelihood += weighing;
  seconds.propagate += whole.seconds() - weighing;
  return particles;
}

void AdaptiveFilter::update_velocity(const std::vector<double>& pose, double dt_s) {
  const auto dofs = options_.body->skeleton.dofs();
  for (size_t d = 0; d < pose.size(); ++d) {
    const double apparent = difference(dofs[d], pose[d], pose_[d]) / dt_s;
    velocity_[d] += kVelocityGain * (apparent - velocity_[d]);
  }
}

}  // namespace silpose
