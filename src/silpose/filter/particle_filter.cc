#include "silpose/filter/particle_filter.h"

#include "silpose/base/check.h"

namespace silpose {

ParticleFilter::ParticleFilter(StateBatch states, std::shared_ptr<const Resampler> resampler,
                               ParticleFilterOptions options)
    : SteppedParticles(std::move(states)), resampler_(std::move(resampler)), options_(options) {
  check(resampler_ != nullptr, "ParticleFilter: no resampler");
  check(options_.resample_below >= 0, "ParticleFilter: resample_below {}", options_.resample_below);
}

FilterReport ParticleFilter::step(const Propagate& propagate, const LogLikelihood& log_likelihood,
                                  const Regenerate& regenerate) {
  FilterReport report;
  const uint64_t stream = stream_of(now_.step++);

  const double num_effective = effective_sample_size(now_.particles.weights());
  if (options_.resample_below >= 1 || num_effective < options_.resample_below * now_.particles.size()) {
    now_.particles.resample(*resampler_, regenerate, inherit_, options_.seed, stream, report);
  }

  propagate(now_.particles.states, stream);

  std::vector<double> log_likelihoods(now_.particles.log_weights.size());
  log_likelihood(now_.particles.states, log_likelihoods);
  for (size_t i = 0; i < log_likelihoods.size(); ++i) now_.particles.log_weights[i] += log_likelihoods[i];

  const Normalisation normalisation = normalise_log_weights(now_.particles.log_weights);
  report.effective_sample_size = normalisation.effective_sample_size;
  report.log_evidence = normalisation.log_sum;
  report.degenerate = normalisation.degenerate;
  return report;
}

}  // namespace silpose
