#include "silpose/track/fitted_filter.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "silpose/base/clock.h"
#include "silpose/filter/log_weights.h"
#include "silpose/track/pose_estimate.h"

namespace silpose {
namespace {

// Outlines are never trusted further than this, however well a body may fit: its skin has its own errors.
constexpr double kLeastNoise = 1;
constexpr double kFirstNoise = 4;
// How many frames the estimate of the noise looks back.
constexpr double kNoiseMemory = 10;
// Numbers that a fit takes from an outline: what they explain is not left in the residual.
constexpr double kFittedNumbers = 15;

MixtureOptions mixture_options(const TrackerOptions& options) {
  return {.num_hypotheses = *options.num_hypotheses, .seed = options.seed};
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
                           std::shared_ptr<const CoverageLikelihood> coarse)
    : fine_(fine), mixture_(std::move(fine), std::move(coarse), mixture_options(options)) {}

void FittedFilter::start(std::span<const StartingPose> starts) {
  mixture_.start(poses_of(starts));
  noise_.assign(fine_->cameras().size(), kFirstNoise);
  report();
}

void FittedFilter::add(std::span<const StartingPose> starts) {
  mixture_.add(poses_of(starts));
}

FilterReport FittedFilter::step(std::span<const Observation> observations, double dt_s, StepSeconds& seconds) {
  const Stopwatch stopwatch;
  CoverageEvidence evidence = fine_->prepare(observations, Blur::k8);
  for (size_t c = 0; c < noise_.size(); ++c) evidence.noise[c] = noise_[c] * std::pow(evidence.views[c].pixel_unit, 3);
  mixture_.step(evidence, dt_s);
  estimate_noise(evidence);
  seconds.likelihood += stopwatch.seconds();
  return report();
}

FilterReport FittedFilter::coast(double dt_s) {
  mixture_.coast(dt_s);
  return report();
}

// White noise along the outline, of variance s^2 and correlation length l, leaves s^2 l L / (2 sqrt(pi) sigma) after a
// blur wider than l, of which the fit explains some.
void FittedFilter::estimate_noise(const CoverageEvidence& evidence) {
  const GaussianComponent& best = mixture_.hypotheses().front();
  const std::vector<double> pose(best.pose().begin(), best.pose().end());
  CoverageLikelihood::Scratch scratch(*fine_);
  const std::vector<double> residual = fine_->residuals(evidence, Blur::k8, pose, scratch);
  for (size_t c = 0; c < noise_.size(); ++c) {
    const CoverageEvidence::View& view = evidence.views[c];
    if (view.trust <= 0 || view.outline_length <= 0) continue;
    const double along = 2 * std::sqrt(std::numbers::pi) * view.rasters[static_cast<size_t>(Blur::k8)].cell;
    const double segments = view.outline_length / along;
    const double left = std::max(segments - kFittedNumbers, 0.25 * segments) / segments;
    const double found = residual[c] * along / (view.outline_length * left) / std::pow(view.pixel_unit, 3);
    const double log_noise = std::log(noise_[c]) + (std::log(std::max(found, kLeastNoise)) - std::log(noise_[c])) / kNoiseMemory;
    noise_[c] = std::exp(log_noise);
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

std::vector<double> FittedFilter::estimate() const {
  const auto best = particles_.states.row(0).head(particles_.states.cols() / 2);
  return {best.begin(), best.end()};
}

PoseSpread FittedFilter::spread() const {
  const BodyModel& body = fine_->body();
  const auto hypotheses = mixture_.hypotheses();
  const std::vector<double> centre = estimate();
  const auto centre_landmarks = landmark_positions(body, centre);
  const std::vector<double> weights = particles_.weights();
  PoseSpread spread;
  spread.dofs.assign(centre.size(), 0);
  spread.landmarks.assign(centre_landmarks.size(), Eigen::Vector3d::Zero());
  for (size_t i = 0; i < hypotheses.size(); ++i) {
    const auto covariance = hypotheses[i].pose_covariance();
    const auto row = particles_.states.row(static_cast<Eigen::Index>(i)).head(std::ssize(centre));
    const std::vector<double> pose(row.begin(), row.end());
    for (size_t d = 0; d < pose.size(); ++d) {
      double off = pose[d] - centre[d];
      if (body.skeleton.dofs()[d].is_periodic) off = wrap_angle(off);
      spread.dofs[d] += weights[i] * (covariance(static_cast<Eigen::Index>(d), static_cast<Eigen::Index>(d)) + off * off);
    }
    const auto landmarks = landmark_positions(body, pose);
    const std::vector<Eigen::Vector3d> variances = landmark_variances(body, pose, covariance);
    for (size_t l = 0; l < landmarks.size(); ++l) {
      spread.landmarks[l] += weights[i] * (variances[l] + (landmarks[l] - centre_landmarks[l]).cwiseAbs2());
    }
  }
  for (double& variance : spread.dofs) variance = std::sqrt(variance);
  for (Eigen::Vector3d& variance : spread.landmarks) variance = variance.cwiseSqrt();
  return spread;
}

}  // namespace silpose
