#include "silpose/filter/particle_set.h"

#include <cmath>
#include <utility>

#include "silpose/base/check.h"

namespace silpose {

ParticleSet ParticleSet::uniform(StateBatch states) {
  check(states.rows() >= 1, "ParticleSet: no particles");
  ParticleSet set{std::move(states), {}};
  set.log_weights.assign(static_cast<size_t>(set.size()), -std::log(static_cast<double>(set.size())));
  return set;
}

void ParticleSet::resample(const Resampler& resampler, const Regenerate& regenerate, const Inherit& inherit,
                           uint64_t seed, uint64_t stream, FilterReport& report) {
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
  if (inherit) inherit(ancestors);
  report.resampled = true;
  report.num_regenerated = static_cast<int>(new_rows.size());
}

}  // namespace silpose
