#include "silpose/track/sampling_filter.h"

#include <algorithm>
#include <cmath>

#include "silpose/base/check.h"
#include "silpose/base/clock.h"
#include "silpose/fit/limbs.h"
#include "silpose/track/pose_estimate.h"

namespace silpose {
namespace {

// [guess] Particles start within the noise of this many frames of the pose that descent found.
constexpr double kStartFrames = 4;
constexpr double kSurvivalRate = 0.5;  // of each annealing layer

}  // namespace

SamplingFilter::SamplingFilter(const SamplingOptions& options, const SilhouetteLikelihood& likelihood,
                               std::vector<bool> free_dofs, uint64_t seed)
    : options_(options),
      likelihood_(likelihood),
      free_dofs_(std::move(free_dofs)),
      seed_(seed),
      motion_(make_motion_model(options.motion, skeleton(), likelihood.body().profile, {.sigma_deg = options.sigma_deg})
                  .value()),
      resampler_(make_resampler(options.resampling, options.regenerate).value()) {}

void SamplingFilter::start(std::span<const double> pose) {
  check(std::ssize(pose) == skeleton().num_dofs(), "SamplingFilter: start pose of {} numbers", pose.size());
  const StateBatch one = Eigen::Map<const Eigen::RowVectorXd>(pose.data(), std::ssize(pose));
  StateBatch states = motion_->states_from_poses(one.replicate(options_.num_particles, 1));
  std::vector<double> deviation(motion_->deviation().begin(), motion_->deviation().end());
  const std::vector<int> columns = free_columns();
  for (size_t d = 0; d < deviation.size(); ++d) {
    const bool moves = std::find(columns.begin(), columns.end(), static_cast<int>(d)) != columns.end();
    deviation[d] = moves ? deviation[d] * std::sqrt(kStartFrames) : 0;
  }
  motion_->diffuse(states, deviation, seed_, kStartStream);
  make_filter(std::move(states));
}

void SamplingFilter::make_filter(StateBatch states) {
  if (options_.num_layers == 1) {
    filter_.emplace<ParticleFilter>(std::move(states), resampler_,
                                    ParticleFilterOptions{.resample_below = options_.resample_below, .seed = seed_});
  } else {
    AnnealedFilterOptions annealed{.num_layers = options_.num_layers,
                                   .survival_rate = kSurvivalRate,
                                   .deviation = {motion_->deviation().begin(), motion_->deviation().end()},
                                   .adaptive_noise = true,
                                   .circular = periodic_dofs(skeleton()),
                                   .seed = seed_};
    for (const auto& limb : limb_blocks(likelihood_.body())) annealed.blocks.push_back(motion_->columns_of(limb));
    filter_.emplace<AnnealedFilter>(std::move(states), resampler_, std::move(annealed));
  }
}

FilterReport SamplingFilter::step(const Evidence& evidence, const StateBatch& recognised, std::span<const double> held,
                                  double dt_s, StepSeconds& seconds) {
  const Stopwatch whole;
  double propagating = 0, weighing = 0;
  const Propagate propagate = [&](StateBatch& states, uint64_t stream) {
    const Stopwatch stopwatch;
    motion_->propagate(states, dt_s, seed_, stream);
    hold(states, held);
    propagating += stopwatch.seconds();
  };
  const LogLikelihood weigh = [&](const StateBatch& states, std::span<double> out) {
    const Stopwatch stopwatch;
    likelihood_.log_likelihood(evidence, states, out);
    weighing += stopwatch.seconds();
  };
  const Diffuse diffuse = [&](StateBatch& states, std::span<const double> deviation, uint64_t stream) {
    const Stopwatch stopwatch;
    motion_->diffuse(states, deviation, seed_, stream);
    hold(states, held);
    propagating += stopwatch.seconds();
  };
  // New particles are drawn about what a network recognised, or the estimate, three times as wide as one frame's noise.
  const std::vector<double> centre = estimate();
  const Regenerate regenerate = [&](StateBatch& states, std::span<const int> rows, uint64_t stream) {
    StateBatch poses(std::ssize(rows), std::ssize(centre));
    for (Eigen::Index i = 0; i < poses.rows(); ++i) {
      if (recognised.rows() > 0) {
        poses.row(i) = recognised.row(i % recognised.rows());
      } else {
        poses.row(i) = Eigen::Map<const Eigen::RowVectorXd>(centre.data(), std::ssize(centre));
      }
    }
    StateBatch fresh = motion_->states_from_poses(poses);
    std::vector<double> wide(motion_->deviation().begin(), motion_->deviation().end());
    for (double& deviation : wide) deviation *= 3;
    motion_->diffuse(fresh, wide, seed_ ^ kRegenerateSeed, stream);
    for (size_t i = 0; i < rows.size(); ++i) states.row(rows[i]) = fresh.row(static_cast<Eigen::Index>(i));
  };
  FilterReport report = std::visit(
      [&](auto& filter) -> FilterReport {
        if constexpr (std::is_same_v<std::decay_t<decltype(filter)>, ParticleFilter>) {
          return filter.step(propagate, weigh, regenerate);
        } else if constexpr (std::is_same_v<std::decay_t<decltype(filter)>, AnnealedFilter>) {
          return filter.step(propagate, diffuse, weigh, regenerate);
        } else {
          throw std::invalid_argument("SamplingFilter: step before start");
        }
      },
      filter_);
  seconds.propagate += propagating;
  seconds.likelihood += weighing;
  seconds.resample += whole.seconds() - propagating - weighing;
  return report;
}

FilterReport SamplingFilter::coast(double dt_s) {
  // What is held stays where each particle has it.
  const Propagate propagate = [&](StateBatch& states, uint64_t stream) {
    const StateBatch before = states;
    motion_->propagate(states, dt_s, seed_, stream);
    for (const int d : held_columns()) states.col(d) = before.col(d);
  };
  return std::visit(
      [&](auto& filter) -> FilterReport {
        if constexpr (std::is_same_v<std::decay_t<decltype(filter)>, std::monostate>) {
          throw std::invalid_argument("SamplingFilter: coast before start");
        } else {
          return filter.coast(propagate);
        }
      },
      filter_);
}

const ParticleSet& SamplingFilter::particles() const {
  if (const auto* annealed = std::get_if<AnnealedFilter>(&filter_)) return annealed->particles();
  check(std::holds_alternative<ParticleFilter>(filter_), "SamplingFilter: particles before start");
  return std::get<ParticleFilter>(filter_).particles();
}

std::optional<FilterState> SamplingFilter::state() const {
  if (const auto* annealed = std::get_if<AnnealedFilter>(&filter_)) return annealed->state();
  if (const auto* plain = std::get_if<ParticleFilter>(&filter_)) return plain->state();
  return std::nullopt;
}

void SamplingFilter::restore(std::optional<FilterState> state) {
  filter_.emplace<std::monostate>();
  if (!state) return;
  const ParticleSet& particles = state->particles;
  check(particles.size() == options_.num_particles && std::ssize(particles.log_weights) == particles.size() &&
            particles.states.cols() == std::ssize(motion_->deviation()),
        "SamplingFilter: not a state of it: {} particles of {} numbers", particles.size(), particles.states.cols());
  make_filter(particles.states);
  if (auto* annealed = std::get_if<AnnealedFilter>(&filter_)) {
    annealed->restore(std::move(*state));
  } else {
    std::get<ParticleFilter>(filter_).restore(std::move(*state));
  }
}

std::vector<double> SamplingFilter::estimate() const {
  return pose_estimate(skeleton(), particles(), options_.estimate, motion_->deviation());
}

std::vector<int> SamplingFilter::columns_where(bool moves) const {
  std::vector<int> dofs;
  for (size_t d = 0; d < free_dofs_.size(); ++d) {
    if (free_dofs_[d] == moves) dofs.push_back(static_cast<int>(d));
  }
  return motion_->columns_of(dofs);
}

void SamplingFilter::hold(StateBatch& states, std::span<const double> held) const {
  for (size_t d = 0; d < free_dofs_.size(); ++d) {
    if (!free_dofs_[d]) states.col(static_cast<Eigen::Index>(d)).setConstant(held[d]);
  }
}

}  // namespace silpose
