// ParticleFilter: sequential importance resampling over rows of numbers. It knows nothing about bodies: batch callables
// given to each step move particles, weigh them and regenerate lost ones.
// Based on: Salmond & Gordon 2005; thesis section 2.4 (references.bib: salmond2005, cormier2019).
// Threads: one thread at a time; the callables may be parallel inside. Results depend on the seed alone.
#pragma once

#include <memory>
#include <utility>

#include "silpose/filter/stepped_particles.h"

namespace silpose {

struct ParticleFilterOptions {
  double resample_below = 0.5;  // resample when effective sample size / N is below this; 1: every step; 0: never
  uint64_t seed = 1;
};

class ParticleFilter : public SteppedParticles {
 public:
  // Starts from states [N, D], equally weighted.
  // Errors: throws std::invalid_argument without states or resampler, or for options out of range.
  ParticleFilter(StateBatch states, std::shared_ptr<const Resampler> resampler, ParticleFilterOptions options = {});

  // One observation: resample if few particles count, propagate, weigh, normalise.
  // `regenerate` is needed when the resampler asks for new particles. Errors: throws std::invalid_argument without it.
  FilterReport step(const Propagate& propagate, const LogLikelihood& log_likelihood, const Regenerate& regenerate = {});

 private:
  std::shared_ptr<const Resampler> resampler_;
  ParticleFilterOptions options_;
};

}  // namespace silpose
