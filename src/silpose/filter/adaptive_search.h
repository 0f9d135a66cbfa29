// adaptive_search(): annealed layers whose noise has a full covariance, learned on the way. Each layer draws particles
// from a Gaussian that starts as the prior; the best of them, by posterior, move its mean and reshape its covariance, so
// that columns which trade off against each other (a hip and a knee, size and depth) are searched along the trade.
// Based on: the rank-mu update of CMA-ES (references.bib: hansen2016), here with the temporal prior in the objective.
// Threads: a function without state, parallel inside; the same result for any number of threads.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "silpose/filter/particle_set.h"

namespace silpose {

struct AdaptiveSearchOptions {
  int num_particles = 500;      // N, a layer
  int num_layers = 10;
  double elite_fraction = 0.25; // of a layer: those that shape the next
  double survival_rate = 0.25;  // effective sample size / N that the last layer's weights are flattened to
  uint64_t seed = 1;
};

// Independent Gaussian of each column; columns of deviation 0 stay where they are.
struct GaussianPrior {
  std::vector<double> mean;       // [D]
  std::vector<double> deviation;  // [D]
};

// Brings one state [D] back inside its limits.
using KeepValid = std::function<void(std::span<double> state)>;

// The last layer's particles [N, D], weighted by prior times likelihood, flattened.
// Errors: throws std::invalid_argument for sizes that disagree, fewer than 4 particles, a NaN log-likelihood.
ParticleSet adaptive_search(const GaussianPrior& prior, const AdaptiveSearchOptions& options, uint64_t step,
                            const KeepValid& keep_valid, const LogLikelihood& log_likelihood, FilterReport& report);

}  // namespace silpose
