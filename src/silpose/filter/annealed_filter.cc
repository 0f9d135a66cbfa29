#include "silpose/filter/annealed_filter.h"

#include <algorithm>

#include "silpose/base/check.h"
#include "silpose/filter/annealing.h"
#include "silpose/filter/estimate.h"

namespace silpose {

AnnealedFilter::AnnealedFilter(StateBatch states, std::shared_ptr<const Resampler> resampler,
                               AnnealedFilterOptions options)
    : SteppedParticles(std::move(states)),
      resampler_(std::move(resampler)),
      between_layers_(make_resampler("systematic").value()),
      options_(std::move(options)) {
  check(resampler_ != nullptr, "AnnealedFilter: no resampler");
  check(options_.num_layers >= 1 && options_.num_layers < kMaxLayers, "AnnealedFilter: {} layers", options_.num_layers);
  check(options_.survival_rate > 0 && options_.survival_rate <= 1, "AnnealedFilter: survival rate {}",
        options_.survival_rate);
  check(options_.deviation.size() == static_cast<size_t>(now_.particles.states.cols()),
        "AnnealedFilter: {} deviations for {} columns", options_.deviation.size(), now_.particles.states.cols());
  check(options_.exchange >= 0 && options_.exchange <= 1, "AnnealedFilter: exchange {}", options_.exchange);
}

FilterReport AnnealedFilter::step(const Propagate& propagate, const Diffuse& diffuse,
                                  const LogLikelihood& log_likelihood, const Regenerate& regenerate) {
  FilterReport report;
  const uint64_t step = now_.step++;
  now_.particles.resample(*resampler_, regenerate, inherit_, options_.seed, stream_of(step), report);
  propagate(now_.particles.states, stream_of(step));
  run_layers(step, diffuse, log_likelihood, report);
  return report;
}

void AnnealedFilter::run_layers(uint64_t step, const Diffuse& diffuse, const LogLikelihood& log_likelihood,
                                FilterReport& report) {
  std::vector<double>& log_weights = now_.particles.log_weights;
  for (int layer = 0;; ++layer) {
    log_likelihood(now_.particles.states, log_weights);
    const double exponent = annealing_exponent(log_weights, options_.survival_rate, options_.max_exponent);
    report.layer_exponent.push_back(exponent);
    for (double& value : log_weights) value *= exponent;
    const Normalisation normalisation = normalise_log_weights(log_weights);
    report.effective_sample_size = normalisation.effective_sample_size;
    report.degenerate = normalisation.degenerate;
    if (layer + 1 == options_.num_layers) return;

    const uint64_t stream = stream_of(step, layer + 1);
    const auto best_idx = mode_index(log_weights);
    const Eigen::RowVectorXd best = now_.particles.states.row(best_idx);
    const std::vector<double> deviation = noise_deviation(layer);
    std::vector<int> ancestors;
    now_.particles.states = recombine(stream, ancestors);
    diffuse(now_.particles.states, deviation, stream);
    now_.particles.states.row(0) = best;
    ancestors.front() = static_cast<int>(best_idx);
    if (inherit_) inherit_(ancestors);
  }
}

StateBatch AnnealedFilter::recombine(uint64_t stream, std::vector<int>& first) const {
  Rng rng(options_.seed, stream, kResamplingParticle);
  const int num_particles = now_.particles.size();
  first = between_layers_->resample(now_.particles.log_weights, num_particles, rng);
  // Shuffled, for both lists come sorted and would pair every particle with itself.
  std::vector<int> second = between_layers_->resample(now_.particles.log_weights, num_particles, rng);
  for (size_t i = second.size(); i > 1; --i) std::swap(second[i - 1], second[rng.index(i)]);
  return crossover(now_.particles.states, first, second, options_.blocks, options_.exchange, options_.seed, stream);
}

std::vector<double> AnnealedFilter::noise_deviation(int layer) const {
  std::vector<double> deviation = options_.deviation;
  const double scale = annealing_noise_scale(layer, options_.survival_rate);
  for (double& value : deviation) value *= scale;
  if (options_.adaptive_noise) {
    const std::vector<double> spread =
        weighted_deviation(now_.particles.states, now_.particles.weights(), options_.circular);
    for (size_t d = 0; d < deviation.size(); ++d) deviation[d] = std::min(options_.deviation[d], spread[d]);
  }
  return deviation;
}

}  // namespace silpose
