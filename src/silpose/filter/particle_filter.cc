#include "silpose/filter/particle_filter.h"

#include "silpose/base/check.h"

namespace silpose {

ParticleFilter::ParticleFilter(StateBatch states, std::shared_ptr<const Resampler> resampler,
                               ParticleFilterOptions options)
    : resampler_(std::move(resampler)), options_(options), particles_(ParticleSet::uniform(std::move(states))) {
  check(resampler_ != nullptr, "ParticleFilter: no resampler");
  check(options_.resample_below >= 0, "ParticleFilter: resample_below {}", options_.resample_below);
}

FilterReport ParticleFilter::step(const Propagate& propagate, const LogLikelihood& log_likelihood,
                                  const Regenerate& regenerate) {
  FilterReport report;
  const uint64_t stream = stream_of(step_++);

  const double num_effective = effective_sample_size(particles_.weights());
  if (options_.resample_below >= 1 || num_effective < options_.resample_below * particles_.size()) {
    particles_.resample(*resampler_, regenerate, options_.seed, stream, report);
  }

  propagate(particles_.states, stream);

  std::vector<double> log_likelihoods(particles_.log_weights.size());
  log_likelihood(particles_.states, log_likelihoods);
  for (size_t i = 0; i < log_likelihoods.size(); ++i) particles_.log_weights[i] += log_likelihoods[i];

  const Normalisation normalisation = normalise_log_weights(particles_.log_weights);
  report.effective_sample_size = normalisation.effective_sample_size;
  report.log_evidence = normalisation.log_sum;
  report.degenerate = normalisation.degenerate;
  return report;
}

FilterReport ParticleFilter::coast(const Propagate& propagate) {
  FilterReport report;
  propagate(particles_.states, stream_of(step_++));
  report.effective_sample_size = effective_sample_size(particles_.weights());
  return report;
}

}  // namespace silpose
