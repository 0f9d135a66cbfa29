// Annealing: the parts of an annealed layer. A layer weighs particles by likelihood^exponent with an exponent so small
// that a chosen share of them survives, then scatters the survivors less than the layer before did, so that the set
// moves from broad peaks to narrow ones. Crossover lets blocks of columns (limbs) of good particles recombine.
// Based on: Deutscher & Reid 2005 (references.bib: deutscher2005; deutscher2000 for the decay of the noise).
// Threads: functions without state; the same result for any number of threads.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "silpose/filter/state_batch.h"

namespace silpose {

// The exponent, at most max_exponent, at which the effective sample size of likelihood^exponent is survival_rate x the
// number of particles with any likelihood. It is max_exponent when even that keeps more alive (all alike).
// Errors: throws std::invalid_argument for NaN or plus infinity, or a survival rate outside (0, 1].
// Source: deutscher2005; by bisection.
[[nodiscard]] double annealing_exponent(std::span<const double> log_likelihood, double survival_rate,
                                        double max_exponent);

// What the deviation of a layer's noise is multiplied by, layer counted from 0: variance falls by the survival rate a
// layer. Source: deutscher2000.
[[nodiscard]] double annealing_noise_scale(int layer, double survival_rate);

// Children [M, D] of pairs of parents: each is its first parent with every block of columns replaced, with probability
// `exchange`, by its second parent's. Columns in no block come from the first parent. Child i uses the stream
// (seed, stream, i). When both parents are drawn by weight, every block keeps the distribution it had.
// Shapes: parents [N, D]; first, second [M] rows of parents.
// Errors: throws std::invalid_argument for rows or columns out of range.
// Source: deutscher2005.
[[nodiscard]] StateBatch crossover(const StateBatch& parents, std::span<const int> first, std::span<const int> second,
                                   std::span<const std::vector<int>> blocks, double exchange, uint64_t seed,
                                   uint64_t stream);

}  // namespace silpose
