// AnnealedFilter: a particle filter in which every step goes through layers that sharpen the likelihood and narrow the
// noise, to find the best of many peaks with few particles. Its weights are no posterior (they are as flat as the
// survival rate makes them): the mean is good, the spread says how narrow the last layer is.
// Based on: Deutscher & Reid 2005 (references.bib: deutscher2005). One thing is ours: the best particle so far goes
// through every layer unchanged, so that a step never loses what it found.
// Threads: one thread at a time; the callables may be parallel inside. Results depend on the seed alone.
#pragma once

#include <memory>
#include <utility>

#include "silpose/filter/stepped_particles.h"

namespace silpose {

// Adds noise of the given standard deviation [D], a column each, to states [N, D], and keeps them valid (limits).
using Diffuse = std::function<void(StateBatch& states, std::span<const double> deviation, uint64_t stream)>;

struct AnnealedFilterOptions {
  int num_layers = 10;                   // 1 to kMaxLayers - 1
  double survival_rate = 0.5;            // share of particles that a layer keeps, in (0, 1]
  std::vector<double> deviation;         // [D] noise after the first layer; later layers get less
  bool adaptive_noise = false;           // instead of decaying: a column's own spread in the layer, at most `deviation`
  std::vector<std::vector<int>> blocks;  // columns that go together in crossover; none: no crossover
  double exchange = 0.5;                 // probability that a child takes a block from its second parent
  double max_exponent = 1e6;             // no layer is sharper than likelihood^max_exponent
  std::vector<int> circular;             // columns that wrap
  uint64_t seed = 1;
};

class AnnealedFilter : public SteppedParticles {
 public:
  // Starts from states [N, D], equally weighted. `resampler` acts between steps; between layers it is systematic.
  // Errors: throws std::invalid_argument for options out of range.
  AnnealedFilter(StateBatch states, std::shared_ptr<const Resampler> resampler, AnnealedFilterOptions options);

  // One observation: resample, propagate, then the layers: weigh, recombine, diffuse; weigh.
  // `regenerate` is needed when the resampler asks for new particles. Errors: throws std::invalid_argument without it.
  FilterReport step(const Propagate& propagate, const Diffuse& diffuse, const LogLikelihood& log_likelihood,
                    const Regenerate& regenerate = {});

 private:
  void run_layers(uint64_t step, const Diffuse& diffuse, const LogLikelihood& log_likelihood, FilterReport& report);
  // `first`: the parent that each new particle has most of. [N]
  StateBatch recombine(uint64_t stream, std::vector<int>& first) const;
  std::vector<double> noise_deviation(int layer) const;

  std::shared_ptr<const Resampler> resampler_;
  std::unique_ptr<const Resampler> between_layers_;
  AnnealedFilterOptions options_;
};

}  // namespace silpose
