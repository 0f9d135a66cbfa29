// Estimates from a weighted particle set: mean, mode, the mean of the cluster around the mode, and spread. Circular
// columns are angles in radians whose values wrap: their mean is the direction of the mean unit vector.
// Source: weighted mean, thesis eq. 2.20 (references.bib: cormier2019); mean shift, comaniciu2002.
// Threads: functions without state; sums run in index order.
#pragma once

#include <span>
#include <vector>

#include "silpose/filter/state_batch.h"

namespace silpose {

// Weighted mean [D] of states [N, D] with weights [N] (they need not sum to 1). `circular`: the columns that wrap.
// A circular column without a mean direction (balanced all around) gives that of its heaviest particle.
// Errors: throws std::invalid_argument unless the sizes agree and some weight is positive.
// Source: cormier2019 eq. 2.20.
[[nodiscard]] std::vector<double> weighted_mean(const StateBatch& states, std::span<const double> weight,
                                                std::span<const int> circular = {});

// Weighted standard deviation [D] about the weighted mean; circular columns measure the shorter way around.
[[nodiscard]] std::vector<double> weighted_deviation(const StateBatch& states, std::span<const double> weight,
                                                     std::span<const int> circular = {});

// The row of the highest weight, the first of equals. Weights or log weights alike. REQUIRES: not empty, no NaN.
[[nodiscard]] int mode_index(std::span<const double> weight);

struct Cluster {
  std::vector<double> mean;  // [D]
  double weight = 0;         // share of all weight that lies within one bandwidth of the mean: 1 when all agree
};

// Where mean shift from the mode converges: the estimate for a posterior with several hypotheses. The distance of two
// states is the root mean square over columns of their difference / scale [D]; columns of scale 0 do not count.
// Errors: as weighted_mean; bandwidth not positive; scale negative or all 0.
// Source: comaniciu2002, Gaussian kernel.
[[nodiscard]] Cluster cluster_estimate(const StateBatch& states, std::span<const double> weight,
                                       std::span<const double> scale, double bandwidth,
                                       std::span<const int> circular = {});

}  // namespace silpose
