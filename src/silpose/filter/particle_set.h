// ParticleSet: states with their log weights, and the moves that every filter makes with them.
// Threads: a value.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <tuple>
#include <vector>

#include "silpose/filter/log_weights.h"
#include "silpose/filter/resampling.h"
#include "silpose/filter/state_batch.h"

namespace silpose {

// Moves every state [N, D] forward in time. `stream` is the step coordinate of the random streams to use (base/rng.h).
using Propagate = std::function<void(StateBatch& states, uint64_t stream)>;
// Log-likelihood [N] of states [N, D], up to a constant; minus infinity is impossible.
using LogLikelihood = std::function<void(const StateBatch& states, std::span<double> log_likelihood)>;
// Regenerates the given rows: at random, or by a proposal.
using Regenerate = std::function<void(StateBatch& states, std::span<const int> rows, uint64_t stream)>;
// Is called after every resampling, those between the layers of annealing too, for what belongs to particles but is no
// row of numbers. Particle n continues particle ancestors[n], or is regenerated (kRegenerate). Of a crossover it is the
// first parent. [N]
using Inherit = std::function<void(std::span<const int> ancestors)>;

struct FilterReport {
  double effective_sample_size = 0;  // after weighing
  double log_evidence = 0;           // log of the likelihood averaged over the predicted particles; plain filter only
  bool resampled = false;            // before propagation
  int num_regenerated = 0;
  bool degenerate = false;             // no particle explained the observation: weights are uniform
  std::vector<double> layer_exponent;  // annealing only: by layer
};

struct ParticleSet {
  StateBatch states;                // [N, D]
  std::vector<double> log_weights;  // [N], normalised

  // Equally weighted. REQUIRES: N >= 1.
  static ParticleSet uniform(StateBatch states);

  [[nodiscard]] int size() const { return static_cast<int>(states.rows()); }
  [[nodiscard]] std::vector<double> weights() const { return weights_from_log_weights(log_weights); }

  // N new particles, equally weighted; notes in `report` that it happened.
  // Errors: throws std::invalid_argument when new particles are asked for and `regenerate` is empty.
  void resample(const Resampler& resampler, const Regenerate& regenerate, const Inherit& inherit, uint64_t seed,
                uint64_t stream, FilterReport& report);

  static auto members(auto& s) { return std::tie(s.states, s.log_weights); }
};

// The stream coordinate of a layer of a step. A step has at most kMaxLayers; layer 0 is the step's own. [definition]
inline constexpr int kMaxLayers = 256;
inline constexpr uint64_t stream_of(uint64_t step, int layer = 0) {
  return step * kMaxLayers + static_cast<uint64_t>(layer);
}

// The particle coordinate of the stream that resampling uses, which no particle has. [definition]
inline constexpr uint64_t kResamplingParticle = ~uint64_t{0};

}  // namespace silpose
