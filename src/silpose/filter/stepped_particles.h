// SteppedParticles: what every particle filter carries from step to step, and may be changed from outside in between.
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

  // ParticleSet::inject: candidates [K, D] for the K lowest weighted particles.
  void inject(const StateBatch& candidates) { now_.particles.inject(candidates); }

  // Starts over from states [N, D], equally weighted; the step counter continues.
  void restart(StateBatch states) { now_.particles = ParticleSet::uniform(std::move(states)); }

  [[nodiscard]] const ParticleSet& particles() const { return now_.particles; }

  // State from which another filter with the same options continues exactly as this one would. REQUIRES: states of the
  // same D.
  [[nodiscard]] const FilterState& state() const { return now_; }
  void restore(FilterState state) { now_ = std::move(state); }

 protected:
  explicit SteppedParticles(StateBatch states) : now_{ParticleSet::uniform(std::move(states))} {}

  FilterState now_;
};

}  // namespace silpose
