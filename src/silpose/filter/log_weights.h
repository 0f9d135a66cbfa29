// Log weights: normalising, log-sum-exp and the effective sample size. Silhouettes have thousands of pixels, so a
// likelihood underflows as a number: logarithms are kept up to the last step.
// Based on: effective sample size as in thesis eq. 4.1 (references.bib: cormier2019).
// Threads: functions without state; sums run in index order.
#pragma once

#include <span>
#include <vector>

namespace silpose {

// log(sum(exp(log_weight))), safe for values far below zero; minus infinity when all are, or none is given.
// Errors: throws std::invalid_argument for NaN or plus infinity: those are no log-likelihoods.
[[nodiscard]] double log_sum_exp(std::span<const double> log_weight);

struct Normalisation {
  double log_sum = 0;                // of the weights as they came
  double effective_sample_size = 0;  // of the weights as they are now: 1 to N
  bool degenerate = false;           // every weight was zero: they are uniform now, and mean nothing
};

// Scales weights [N] in place to sum to 1. All minus infinity: uniform, with the flag.
// Errors: throws std::invalid_argument for an empty span, NaN or plus infinity.
Normalisation normalise_log_weights(std::span<double> log_weight);

// Weights [N] that sum to 1; uniform when every weight is zero. The input need not be normalised.
[[nodiscard]] std::vector<double> weights_from_log_weights(std::span<const double> log_weight);

// How many equally weighted particles these weights [N] are worth: (sum w)^2 / sum w^2; 0 when all are 0.
// Source: cormier2019 eq. 4.1.
[[nodiscard]] double effective_sample_size(std::span<const double> weight);

}  // namespace silpose
