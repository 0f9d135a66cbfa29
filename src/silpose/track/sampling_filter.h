// SamplingFilter: one particle filter, plain or annealed, over some of a body's DOF; the others are held. The presets'
// pose filters are made of these.
// Based on: annealing and limb crossover, deutscher2005; plain filter, cormier2019 sect. 2.4.
// Threads: as PoseFilter.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <variant>
#include <vector>

#include "silpose/filter/annealed_filter.h"
#include "silpose/filter/particle_filter.h"
#include "silpose/likelihood/silhouette_likelihood.h"
#include "silpose/motion/motion_model.h"
#include "silpose/track/step_report.h"
#include "silpose/track/tracker_options.h"

namespace silpose {

class SamplingFilter {
 public:
  // `free_dofs` [D] says which DOF move. Options are copied. The likelihood outlives the filter; the body is its body.
  SamplingFilter(const SamplingOptions& options, const SilhouetteLikelihood& likelihood, std::vector<bool> free_dofs,
                 uint64_t seed);

  // Particles scattered about a pose [D] by the motion model's noise of a few frames.
  void start(std::span<const double> pose);

  // `held` [D]: where the DOF that do not move are now.
  // `recognised` [K, D]: poses that a network sees; regenerated particles are drawn from them. K = 0: from around the
  // estimate.
  FilterReport step(const Evidence& evidence, const StateBatch& recognised, std::span<const double> held, double dt_s,
                    StepSeconds& seconds);
  FilterReport coast(double dt_s);

  [[nodiscard]] const ParticleSet& particles() const;
  [[nodiscard]] std::vector<double> estimate() const;  // [D]

  // State from which another one with the same options continues; nothing before start().
  // Errors: restore() throws std::invalid_argument for particles of another size.
  [[nodiscard]] std::optional<FilterState> state() const;
  void restore(std::optional<FilterState> state);

 private:
  static constexpr uint64_t kStartStream = ~uint64_t{0};
  static constexpr uint64_t kRegenerateSeed = 0x7265;

  std::vector<int> columns_where(bool moves) const;
  std::vector<int> free_columns() const { return columns_where(true); }
  std::vector<int> held_columns() const { return columns_where(false); }
  void hold(StateBatch& states, std::span<const double> held) const;
  void make_filter(StateBatch states);
  [[nodiscard]] const Skeleton& skeleton() const { return likelihood_.body().skeleton; }

  SamplingOptions options_;
  const SilhouetteLikelihood& likelihood_;
  std::vector<bool> free_dofs_;
  uint64_t seed_;
  std::unique_ptr<const MotionModel> motion_;
  std::shared_ptr<const Resampler> resampler_;
  std::variant<std::monostate, ParticleFilter, AnnealedFilter> filter_;
};

}  // namespace silpose
