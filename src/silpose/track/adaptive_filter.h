// AdaptiveFilter: the default pose filter. A Gaussian about where the last poses lead is the prior; layers of particles
// whose covariance adapts find the posterior's peak and its neighbourhood.
// Based on: filter/adaptive_search.h; prediction by the filter's own output velocity, cormier2019 sect. 2.4.3 (second
// form of first-order motion).
// Threads: as PoseFilter.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "silpose/likelihood/silhouette_likelihood.h"
#include "silpose/motion/motion_model.h"
#include "silpose/track/pose_filter.h"

namespace silpose {

class AdaptiveFilter final : public PoseFilter {
 public:
  // `options` are resolved and outlive the filter.
  AdaptiveFilter(const TrackerOptions& options, std::vector<std::shared_ptr<const BatchRenderer>> renderers);

  void start(std::span<const StartingPose> starts) override;
  FilterReport step(std::span<const Observation> observations, double dt_s, StepSeconds& seconds) override;
  FilterReport coast(double dt_s) override;
  const ParticleSet& particles() const override { return particles_; }
  std::vector<double> estimate() const override;

 private:
  // The layers, with a prior about `mean` that is as wide as the noise of `interval_s`.
  ParticleSet search(const Evidence& evidence, const std::vector<double>& mean, double interval_s,
                     StepSeconds& seconds, FilterReport& report);
  void update_velocity(const std::vector<double>& pose, double dt_s);

  const TrackerOptions& options_;
  SilhouetteLikelihood likelihood_;
  std::unique_ptr<const MotionModel> diffusion_;  // its noise; and how particles spread while coasting
  std::vector<bool> free_dofs_;
  std::vector<double> pose_, velocity_;
  ParticleSet particles_;
  double unseen_s_ = 0;   // how long ago pose_ was found, in terms of the noise since
  bool started_ = false;  // a step has been taken since start(): the pose's change is a velocity
  uint64_t step_ = 0;
};

}  // namespace silpose
