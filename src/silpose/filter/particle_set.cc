#include "silpose/filter/particle_set.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "silpose/base/check.h"

namespace silpose {

ParticleSet ParticleSet::uniform(StateBatch states) {
  check(states.rows() >= 1, "ParticleSet: no particles");
  ParticleSet set{std::move(states), {}};
  set.log_weights.assign(static_cast<size_t>(set.size()), -std::log(static_cast<double>(set.size())));
  return set;
}

void ParticleSet::resample(const Resampler& resampler, const Regenerate& regenerate, uint64_t seed, uint64_t stream,
                           FilterReport& report) {
  Rng rng(seed, stream, kResamplingParticle);
  const std::vector<int> ancestors = resampler.resample(log_weights, size(), rng);

  StateBatch next(states.rows(), states.cols());
  std::vector<int> new_rows;
  for (int i = 0; i < size(); ++i) {
    const int ancestor = ancestors[static_cast<size_t>(i)];
    if (ancestor == kRegenerate) new_rows.push_back(i);
    next.row(i) = states.row(ancestor == kRegenerate ? i : ancestor);
  }
  if (!new_rows.empty()) {
    check(static_cast<bool>(regenerate),
          "ParticleSet: the resampler asks for new particles, but `regenerate` is empty");
    regenerate(next, new_rows, stream);
  }
  *this = uniform(std::move(next));
  report.resampled = true;
  report.num_regenerated = static_cast<int>(new_rows.size());
}

void ParticleSet::inject(const StateBatch& candidates) {
  check(candidates.cols() == states.cols() && candidates.rows() <= states.rows(),
        "ParticleSet: {} x {} candidates for {} x {} states", candidates.rows(), candidates.cols(), states.rows(),
        states.cols());
  if (candidates.rows() == 0) return;
  std::vector<int> order(log_weights.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return log_weights[static_cast<size_t>(a)] < log_weights[static_cast<size_t>(b)];
  });
  const double average = -std::log(static_cast<double>(size()));
  for (Eigen::Index k = 0; k < candidates.rows(); ++k) {
    const int row = order[static_cast<size_t>(k)];
    states.row(row) = candidates.row(k);
    log_weights[static_cast<size_t>(row)] = average;
  }
  normalise_log_weights(log_weights);
}

}  // namespace silpose
