// SteppedParticles: what every particle filter carries from step to step.
// Threads: one thread at a time.
#pragma once

#include <tuple>
#include <utility>

#include "silpose/filter/particle_set.h"

namespace silpose {

// What a filter resumes from, besides its options.
struct FilterState {
  ParticleSet particles;
  uint64_t step = 0;

  static auto members(auto& s) { return std::tie(s.particles, s.step); }
};

class SteppedParticles {
 public:
  // No observation: propagates only; weights stay.
  FilterReport coast(const Propagate& propagate);

  // What is called after every resampling from now on.
  void on_resampling(Inherit inherit) { inherit_ = std::move(inherit); }

  [[nodiscard]] const ParticleSet& particles() const { return now_.particles; }

  // State from which another filter with the same options continues exactly as this one would. REQUIRES: states of the
  // same D.
  [[nodiscard]] const FilterState& state() const { return now_; }
  void restore(FilterState state) { now_ = std::move(state); }

 protected:
  explicit SteppedParticles(StateBatch states) : now_{ParticleSet::uniform(std::move(states))} {}

  FilterState now_;
  Inherit inherit_;
};

}  // namespace silpose
