// FittedFilter: the mixture of fitted hypotheses as a PoseFilter: prepares the observations, weighs them by their
// estimated noise, and reports the estimate and its spread.
// Threads: as PoseFilter.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "silpose/fit/body_error.h"
#include "silpose/fit/pose_prior.h"
#include "silpose/likelihood/coverage_likelihood.h"
#include "silpose/track/mixture_filter.h"
#include "silpose/track/pose_filter.h"
#include "silpose/track/tracker_options.h"

namespace silpose {

class FittedFilter final : public PoseFilter {
 public:
  // REQUIRES: options.fitted().
  FittedFilter(const TrackerOptions& options, std::shared_ptr<const CoverageLikelihood> fine,
               const std::shared_ptr<const CoverageLikelihood>& coarse, std::shared_ptr<const PosePrior> pose_prior);

  void start(std::span<const StartingPose> starts) override;
  void add(std::span<const StartingPose> starts) override;
  FilterReport step(std::span<const Observation> observations, double dt_s, StepSeconds& seconds) override;
  FilterReport coast(double dt_s) override;
  [[nodiscard]] const ParticleSet& particles() const override { return particles_; }  // the hypotheses' poses
  [[nodiscard]] std::vector<double> estimate() const override;
  [[nodiscard]] PoseSpread spread() const override;
  [[nodiscard]] std::vector<double> predict(double dt_s) const override;

  [[nodiscard]] std::vector<double> noise() const override { return noise_; }
  [[nodiscard]] std::string state() const override;
  void restore(std::string_view state) override;

 private:
  void begin_noise(const CoverageEvidence& evidence);
  void update_noise(const CoverageEvidence& evidence);
  FilterReport report();

  std::shared_ptr<const CoverageLikelihood> fine_;
  MixtureFilter mixture_;
  ParticleSet particles_;
  BodyError body_error_;
  EvidenceKind evidence_;
  PoseVariances from_body_;    // of the last estimate
  bool added_ = false;         // hypotheses were added since the last step
  std::vector<double> noise_;  // [C]; empty until the first step
};

}  // namespace silpose
