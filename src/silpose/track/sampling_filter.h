// SamplingFilter: one particle filter, plain or annealed, over some of a body's DOF; the others are held. The presets'
// pose filters are made of these.
// Based on: annealing and limb crossover, deutscher2005; plain filter, cormier2019 sect. 2.4.
// Threads: as PoseFilter.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <variant>
#include <vector>

#include "silpose/filter/annealed_filter.h"
#include "silpose/filter/particle_filter.h"
#include "silpose/likelihood/pose_likelihood.h"
#include "silpose/motion/motion_model.h"
#include "silpose/motion/proposal.h"
#include "silpose/track/step_report.h"
#include "silpose/track/tracker_options.h"

namespace silpose {

class SamplingFilter {
 public:
  // `free_dofs` [D] says which DOF move. Options are copied. The body is the likelihood's.
  SamplingFilter(const SamplingOptions& options, std::shared_ptr<const PoseLikelihood> likelihood,
                 std::shared_ptr<const MotionModel> motion, std::vector<bool> free_dofs, uint64_t seed);

  SamplingFilter(const SamplingFilter&) = delete;
  SamplingFilter& operator=(const SamplingFilter&) = delete;

  // Particles scattered about a pose [D] by the motion model's noise of a few frames.
  void start(std::span<const double> pose);

  // `held` [D]: where the DOF that do not move are now.
  // `proposed`: regenerated particles are drawn from around these. None: from around the estimate.
  FilterReport step(std::span<const Observation> observations, const Proposed& proposed, std::span<const double> held,
                    double dt_s, StepSeconds& seconds);
  FilterReport coast(double dt_s);

  [[nodiscard]] const ParticleSet& particles() const;
  [[nodiscard]] uint64_t num_steps() const;
  [[nodiscard]] std::vector<double> estimate() const;  // [D]
  [[nodiscard]] const BodyModel& body() const { return likelihood_->body(); }

  // State from which another one with the same options continues; nothing before start().
  // Errors: restore() throws std::invalid_argument for particles of another size.
  struct State {
    FilterState filter;
    std::vector<MotionContext::Past> history;
    std::string hidden;  // empty: the motion model has none
    static auto members(auto& s) { return std::tie(s.filter, s.history, s.hidden); }
  };
  [[nodiscard]] std::optional<State> state() const;
  void restore(std::optional<State> state);

 private:
  static constexpr uint64_t kStartStream = ~uint64_t{0};
  static constexpr uint64_t kRegenerateSeed = 0x7265;

  std::vector<int> columns_where(bool moves) const;
  std::vector<int> free_columns() const { return columns_where(true); }
  std::vector<int> held_columns() const { return columns_where(false); }
  void hold(StateBatch& states, std::span<const double> held) const;
  void make_filter(StateBatch states);
  void propagate(StateBatch& states, double dt_s, uint64_t stream) const;
  void regenerate(StateBatch& states, std::span<const int> rows, const Proposed& proposed, uint64_t stream) const;
  void remember_estimate(double dt_s);
  [[nodiscard]] const Skeleton& skeleton() const { return body().skeleton; }

  SamplingOptions options_;
  std::shared_ptr<const PoseLikelihood> likelihood_;
  std::shared_ptr<const MotionModel> motion_;
  std::vector<bool> free_dofs_;
  uint64_t seed_;
  std::shared_ptr<const Resampler> resampler_;
  std::unique_ptr<HiddenStates> hidden_;      // of the particles; null: there are none
  std::vector<MotionContext::Past> history_;  // as many as the motion model uses
  std::variant<std::monostate, ParticleFilter, AnnealedFilter> filter_;
};

}  // namespace silpose
