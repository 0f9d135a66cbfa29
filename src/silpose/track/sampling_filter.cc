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

SamplingFilter::SamplingFilter(const SamplingOptions& options, std::shared_ptr<const PoseLikelihood> likelihood,
                               std::shared_ptr<const MotionModel> motion, std::vector<bool> free_dofs, uint64_t seed)
    : options_(options),
      likelihood_(std::move(likelihood)),
      motion_(std::move(motion)),
      free_dofs_(std::move(free_dofs)),
      seed_(seed),
      resampler_(make_resampler(options.resampling, options.regenerate).value()) {
  const int size = motion_->state_size(), num_dofs = skeleton().num_dofs();
  check(size >= num_dofs && std::ssize(motion_->deviation()) == size,
        "SamplingFilter: a motion model with states of {} numbers and {} deviations for a body of {} DOF", size,
        motion_->deviation().size(), num_dofs);
  for (const bool moves : {false, true}) {
    for (const int column : columns_where(moves)) {
      check(column >= 0 && column < size, "SamplingFilter: a motion model with a column {} of {}", column, size);
    }
  }
}

void SamplingFilter::start(std::span<const double> pose) {
  check(std::ssize(pose) == skeleton().num_dofs(), "SamplingFilter: start pose of {} numbers", pose.size());
  const StateBatch one = Eigen::Map<const Eigen::RowVectorXd>(pose.data(), std::ssize(pose));
  StateBatch states = motion_->states_from_poses(one.replicate(options_.num_particles, 1));
  check(states.rows() == options_.num_particles && states.cols() == motion_->state_size(),
        "SamplingFilter: a motion model that makes states of {} numbers, not {}", states.cols(), motion_->state_size());
  std::vector<double> deviation(motion_->deviation().begin(), motion_->deviation().end());
  const std::vector<int> columns = free_columns();
  for (size_t d = 0; d < deviation.size(); ++d) {
    const bool moves = std::find(columns.begin(), columns.end(), static_cast<int>(d)) != columns.end();
    deviation[d] = moves ? deviation[d] * std::sqrt(kStartFrames) : 0;
  }
  motion_->diffuse(states, deviation, seed_, kStartStream);
  hidden_ = motion_->make_hidden(options_.num_particles);
  history_.clear();
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
    for (const auto& limb : limb_blocks(body())) annealed.blocks.push_back(motion_->columns_of(limb));
    filter_.emplace<AnnealedFilter>(std::move(states), resampler_, std::move(annealed));
  }
  if (!hidden_) return;
  const Inherit inherit = [this](std::span<const int> ancestors) { hidden_->select(ancestors); };
  if (auto* annealed = std::get_if<AnnealedFilter>(&filter_)) annealed->on_resampling(inherit);
  if (auto* plain = std::get_if<ParticleFilter>(&filter_)) plain->on_resampling(inherit);
}

void SamplingFilter::propagate(StateBatch& states, double dt_s, uint64_t stream) const {
  motion_->propagate(states, hidden_.get(), {.dt_s = dt_s, .history = history_, .seed = seed_, .stream = stream});
}

// New particles are drawn about what was proposed, or the estimate, three times as wide as one frame's noise.
void SamplingFilter::regenerate(StateBatch& states, std::span<const int> rows, const Proposed& proposed,
                                uint64_t stream) const {
  check_proposed(proposed, skeleton());
  const std::vector<double> centre = estimate();
  const Eigen::Index K = proposed.poses.rows();
  std::vector<int> chosen;  // of unlike candidates, in proportion
  if (K > 0 && !proposed.log_density.empty()) {
    Rng rng(seed_ ^ kRegenerateSeed, stream, kResamplingParticle);
    chosen = make_resampler("systematic").value()->resample(proposed.log_density, static_cast<int>(rows.size()), rng);
  }
  StateBatch poses(std::ssize(rows), std::ssize(centre));
  for (Eigen::Index i = 0; i < poses.rows(); ++i) {
    if (K == 0) {
      poses.row(i) = Eigen::Map<const Eigen::RowVectorXd>(centre.data(), std::ssize(centre));
    } else {
      poses.row(i) = proposed.poses.row(chosen.empty() ? i % K : chosen[static_cast<size_t>(i)]);
    }
  }
  StateBatch fresh = motion_->states_from_poses(poses);
  std::vector<double> wide(motion_->deviation().begin(), motion_->deviation().end());
  for (double& deviation : wide) deviation *= 3;
  motion_->diffuse(fresh, wide, seed_ ^ kRegenerateSeed, stream);
  for (size_t i = 0; i < rows.size(); ++i) states.row(rows[i]) = fresh.row(static_cast<Eigen::Index>(i));
}

void SamplingFilter::remember_estimate(double dt_s) {
  const auto length = static_cast<size_t>(motion_->history_length());
  if (length == 0) return;
  for (MotionContext::Past& past : history_) past.seconds_ago += dt_s;
  history_.push_back({0, estimate()});
  if (history_.size() > length) history_.erase(history_.begin());
}

FilterReport SamplingFilter::step(std::span<const Observation> observations, const Proposed& proposed,
                                  std::span<const double> held, double dt_s, StepSeconds& seconds) {
  const std::unique_ptr<const PoseLikelihood::Evidence> evidence = likelihood_->prepare(observations);
  const Stopwatch whole;
  double propagating = 0, weighing = 0;
  const Propagate move = [&](StateBatch& states, uint64_t stream) {
    const Stopwatch stopwatch;
    propagate(states, dt_s, stream);
    hold(states, held);
    propagating += stopwatch.seconds();
  };
  const LogLikelihood weigh = [&](const StateBatch& states, std::span<double> out) {
    const Stopwatch stopwatch;
    std::ranges::fill(out, 0.0);
    likelihood_->add_log_likelihood(*evidence, states, out);
    weighing += stopwatch.seconds();
  };
  const Diffuse diffuse = [&](StateBatch& states, std::span<const double> deviation, uint64_t stream) {
    const Stopwatch stopwatch;
    motion_->diffuse(states, deviation, seed_, stream);
    hold(states, held);
    propagating += stopwatch.seconds();
  };
  const Regenerate make_new = [&](StateBatch& states, std::span<const int> rows, uint64_t stream) {
    regenerate(states, rows, proposed, stream);
  };
  FilterReport report = std::visit(
      [&](auto& filter) -> FilterReport {
        if constexpr (std::is_same_v<std::decay_t<decltype(filter)>, ParticleFilter>) {
          return filter.step(move, weigh, make_new);
        } else if constexpr (std::is_same_v<std::decay_t<decltype(filter)>, AnnealedFilter>) {
          return filter.step(move, diffuse, weigh, make_new);
        } else {
          throw std::invalid_argument("SamplingFilter: step before start");
        }
      },
      filter_);
  seconds.propagate += propagating;
  seconds.likelihood += weighing;
  seconds.resample += whole.seconds() - propagating - weighing;
  remember_estimate(dt_s);
  return report;
}

FilterReport SamplingFilter::coast(double dt_s) {
  // What is held stays where each particle has it.
  const Propagate move = [&](StateBatch& states, uint64_t stream) {
    const StateBatch before = states;
    propagate(states, dt_s, stream);
    for (const int d : held_columns()) states.col(d) = before.col(d);
  };
  FilterReport report = std::visit(
      [&](auto& filter) -> FilterReport {
        if constexpr (std::is_same_v<std::decay_t<decltype(filter)>, std::monostate>) {
          throw std::invalid_argument("SamplingFilter: coast before start");
        } else {
          return filter.coast(move);
        }
      },
      filter_);
  remember_estimate(dt_s);
  return report;
}

const ParticleSet& SamplingFilter::particles() const {
  if (const auto* annealed = std::get_if<AnnealedFilter>(&filter_)) return annealed->particles();
  check(std::holds_alternative<ParticleFilter>(filter_), "SamplingFilter: particles before start");
  return std::get<ParticleFilter>(filter_).particles();
}

uint64_t SamplingFilter::num_steps() const {
  if (const auto* annealed = std::get_if<AnnealedFilter>(&filter_)) return annealed->state().step;
  if (const auto* plain = std::get_if<ParticleFilter>(&filter_)) return plain->state().step;
  return 0;
}

std::optional<SamplingFilter::State> SamplingFilter::state() const {
  const auto* annealed = std::get_if<AnnealedFilter>(&filter_);
  const auto* plain = std::get_if<ParticleFilter>(&filter_);
  if (annealed == nullptr && plain == nullptr) return std::nullopt;
  return State{annealed != nullptr ? annealed->state() : plain->state(), history_, hidden_ ? hidden_->state() : ""};
}

void SamplingFilter::restore(std::optional<State> state) {
  filter_.emplace<std::monostate>();
  if (!state) return;
  const ParticleSet& particles = state->filter.particles;
  check(particles.size() == options_.num_particles && std::ssize(particles.log_weights) == particles.size() &&
            particles.states.cols() == std::ssize(motion_->deviation()),
        "SamplingFilter: not a state of it: {} particles of {} numbers", particles.size(), particles.states.cols());
  const auto has_size = [&](const MotionContext::Past& past) { return std::ssize(past.pose) == skeleton().num_dofs(); };
  check(std::ssize(state->history) <= motion_->history_length() && std::ranges::all_of(state->history, has_size),
        "SamplingFilter: not a state of it: {} past estimates for a motion model that uses {}", state->history.size(),
        motion_->history_length());
  hidden_ = motion_->make_hidden(options_.num_particles);
  check(hidden_ != nullptr || state->hidden.empty(),
        "SamplingFilter: not a state of it: hidden states of another motion model");
  if (hidden_) hidden_->restore(state->hidden);
  history_ = std::move(state->history);
  make_filter(particles.states);
  if (auto* annealed = std::get_if<AnnealedFilter>(&filter_)) {
    annealed->restore(std::move(state->filter));
  } else {
    std::get<ParticleFilter>(filter_).restore(std::move(state->filter));
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
