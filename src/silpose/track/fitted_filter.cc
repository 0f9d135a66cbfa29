#include "silpose/track/fitted_filter.h"

#include <algorithm>
#include <cmath>

#include "silpose/base/check.h"
#include "silpose/base/clock.h"
#include "silpose/base/state_bytes.h"
#include "silpose/filter/log_weights.h"
#include "silpose/fit/pose_spread.h"

namespace silpose {
namespace {

// [guess] Frames over which the estimate of the noise is averaged.
constexpr double kNoiseMemory = 10;
constexpr double kFarBetter = 0.5;  // [guess] of the noise until now

MixtureOptions mixture_options(const TrackerOptions& options) {
  return {.num_hypotheses = options.fitted()->num_hypotheses, .seed = options.seed};
}

std::vector<Eigen::VectorXd> poses_of(std::span<const StartingPose> starts) {
  std::vector<Eigen::VectorXd> poses;
  for (const StartingPose& start : starts) {
    poses.emplace_back(Eigen::Map<const Eigen::VectorXd>(start.pose.data(), std::ssize(start.pose)));
  }
  return poses;
}

}  // namespace

FittedFilter::FittedFilter(const TrackerOptions& options, std::shared_ptr<const CoverageLikelihood> fine,
                           const std::shared_ptr<const CoverageLikelihood>& coarse,
                           std::shared_ptr<const PosePrior> pose_prior)
    : fine_(fine),
      mixture_(std::move(fine), coarse, std::move(pose_prior), mixture_options(options)),
      body_error_(coarse->body(), options.cameras, options.size_deviation),
      evidence_(options.evidence) {}

void FittedFilter::start(std::span<const StartingPose> starts) {
  mixture_.start(poses_of(starts));
  noise_.clear();
  report();
}

void FittedFilter::add(std::span<const StartingPose> starts) {
  mixture_.add(poses_of(starts));
  added_ = true;
}

FilterReport FittedFilter::step(std::span<const Observation> observations, double dt_s, StepSeconds& seconds) {
  const Stopwatch stopwatch;
  CoverageEvidence evidence = fine_->evidence_of(observations, Blur::k8, Blur::k2, evidence_);
  if (noise_.empty() || added_) begin_noise(evidence);
  evidence.set_noise(noise_);
  mixture_.step(evidence, dt_s);
  update_noise(evidence);
  FilterReport stepped = report();
  CoverageLikelihood::Scratch scratch(body_error_.likelihood());
  from_body_ = body_error_.variance(evidence, estimate(), scratch);
  seconds.likelihood += stopwatch.seconds();
  return stepped;
}

FilterReport FittedFilter::coast(double dt_s) {
  mixture_.coast(dt_s);
  return report();
}

// The best hypothesis shows how good a fit can be. Later on only one that fits far better counts: then the filter was
// lost until now, and its noise said nothing about the outlines.
void FittedFilter::begin_noise(const CoverageEvidence& evidence) {
  CoverageLikelihood::Scratch scratch(*fine_);
  std::vector<Eigen::VectorXd> poses;
  for (const GaussianComponent& hypothesis : mixture_.hypotheses()) poses.emplace_back(hypothesis.pose());
  const std::vector<double> least = fine_->least_noise(evidence, poses, scratch);
  if (noise_.empty()) noise_.assign(least.size(), 0);
  for (size_t c = 0; c < least.size(); ++c) {
    if (noise_[c] == 0) noise_[c] = least[c] > 0 ? least[c] : CoverageLikelihood::kExactNoise;
    if (least[c] > 0 && least[c] < kFarBetter * noise_[c]) noise_[c] = least[c];
  }
  added_ = false;
}

void FittedFilter::update_noise(const CoverageEvidence& evidence) {
  CoverageLikelihood::Scratch scratch(*fine_);
  const Eigen::VectorXd best = mixture_.hypotheses().front().pose();
  const std::vector<double> found = fine_->estimate_noise(evidence, view(best), scratch);
  for (size_t c = 0; c < noise_.size(); ++c) {
    if (found[c] > 0) noise_[c] *= std::pow(found[c] / noise_[c], 1 / kNoiseMemory);
  }
}

FilterReport FittedFilter::report() {
  const auto hypotheses = mixture_.hypotheses();
  const Eigen::Index D = hypotheses.front().num_dofs();
  particles_.states.resize(std::ssize(hypotheses), 2 * D);
  particles_.log_weights.clear();
  for (size_t i = 0; i < hypotheses.size(); ++i) {
    std::vector<double> pose(hypotheses[i].pose().begin(), hypotheses[i].pose().end());
    fine_->body().skeleton.clamp(pose);
    particles_.states.row(static_cast<Eigen::Index>(i)) << Eigen::Map<const Eigen::RowVectorXd>(pose.data(), D),
        hypotheses[i].mean.tail(D).transpose();
    particles_.log_weights.push_back(hypotheses[i].log_weight);
  }
  FilterReport report;
  report.effective_sample_size = effective_sample_size(particles_.weights());
  return report;
}

std::vector<double> FittedFilter::predict(double dt_s) const {
  std::vector<double> pose = estimate();
  // The first hypothesis is the best one, whose pose the estimate is.
  const auto velocity = particles_.states.row(0).tail(std::ssize(pose));
  for (size_t d = 0; d < pose.size(); ++d) pose[d] += dt_s * velocity[static_cast<Eigen::Index>(d)];
  fine_->body().skeleton.clamp(pose);
  return pose;
}

std::string FittedFilter::state() const {
  return to_bytes(mixture_.state(), noise_, added_, from_body_.dofs, from_body_.landmarks.in_world,
                  from_body_.landmarks.about_root);
}

void FittedFilter::restore(std::string_view state) {
  MixtureFilter::State mixture;
  check(from_bytes(state, mixture, noise_, added_, from_body_.dofs, from_body_.landmarks.in_world,
                   from_body_.landmarks.about_root) &&
            (noise_.empty() || noise_.size() == fine_->cameras().size()),
        "FittedFilter: not a state of it");
  mixture_.restore(std::move(mixture));
  if (!mixture_.hypotheses().empty()) report();
}

std::vector<double> FittedFilter::estimate() const {
  const auto best = particles_.states.row(0).head(particles_.states.cols() / 2);
  return {best.begin(), best.end()};
}

PoseSpread FittedFilter::spread() const {
  const auto hypotheses = mixture_.hypotheses();
  const std::vector<double> centre = estimate();
  const std::vector<double> weights = particles_.weights();
  const PoseScatter scatter(fine_->body(), centre);
  PoseVariances variances = no_variances(centre.size(), fine_->body());
  for (size_t i = 0; i < hypotheses.size(); ++i) {
    const auto row = particles_.states.row(static_cast<Eigen::Index>(i)).head(std::ssize(centre));
    const std::vector<double> pose(row.begin(), row.end());
    scatter.add(weights[i], pose, hypotheses[i].pose_covariance(), variances);
  }
  variances += from_body_;
  return spread_of(variances);
}

}  // namespace silpose
