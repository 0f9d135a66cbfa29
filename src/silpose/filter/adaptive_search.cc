#include "silpose/filter/adaptive_search.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "silpose/base/check.h"
#include "silpose/base/parallel.h"
#include "silpose/base/rng.h"
#include "silpose/filter/annealing.h"

namespace silpose {
namespace {

constexpr double kHalfTurn = 3.14;  // radians

// All in units of the prior's deviation, so that the prior is the standard normal of the free columns.
struct Search {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;
};

// Weights by rank, the same for every layer: positive, falling, summing to 1. Source: hansen2016 eq. 48-50.
Eigen::VectorXd elite_weights(int num_elite) {
  Eigen::VectorXd weights(num_elite);
  for (int i = 0; i < num_elite; ++i) weights[i] = std::log(num_elite + 0.5) - std::log(i + 1.0);
  return weights / weights.sum();
}

// How much of the covariance a layer replaces. Source: hansen2016 eq. 58, times four: layers are few.
double learning_rate(const Eigen::VectorXd& weights, double size) {
  const double effective = 1 / weights.squaredNorm();
  return std::min(0.8, 8 * (effective - 2 + 1 / effective) / ((size + 2) * (size + 2) + effective));
}

}  // namespace

ParticleSet adaptive_search(const GaussianPrior& prior, const AdaptiveSearchOptions& options, uint64_t step,
                            const KeepValid& keep_valid, const LogLikelihood& log_likelihood, FilterReport& report) {
  const int N = options.num_particles;
  const size_t D = prior.mean.size();
  check(N >= 4 && options.num_layers >= 1 && options.num_layers < kMaxLayers, "adaptive_search: {} particles, {} layers",
        N, options.num_layers);
  check(prior.deviation.size() == D, "adaptive_search: {} deviations for {} columns", prior.deviation.size(), D);
  check(options.elite_fraction > 0 && options.elite_fraction <= 1, "adaptive_search: elite fraction {}",
        options.elite_fraction);
  std::vector<size_t> free;
  for (size_t d = 0; d < D; ++d) {
    if (prior.deviation[d] > 0) free.push_back(d);
  }
  const auto F = static_cast<Eigen::Index>(free.size());
  const Eigen::VectorXd weights = elite_weights(std::max(2, static_cast<int>(N * options.elite_fraction)));
  const double rate = learning_rate(weights, static_cast<double>(F));

  Search search{Eigen::VectorXd::Zero(F), Eigen::MatrixXd::Identity(F, F)};
  Eigen::VectorXd best = search.mean;
  double best_value = -std::numeric_limits<double>::infinity();
  ParticleSet particles{StateBatch(N, static_cast<Eigen::Index>(D)), std::vector<double>(static_cast<size_t>(N))};
  Eigen::MatrixXd offsets(F, N);  // from the prior's mean, in its deviations
  for (int layer = 0;; ++layer) {
    const Eigen::MatrixXd factor = search.covariance.llt().matrixL();
    parallel_for(static_cast<size_t>(N), 32, [&](size_t begin, size_t end) {
      for (size_t n = begin; n < end; ++n) {
        const auto column = static_cast<Eigen::Index>(n);
        Rng rng(options.seed, stream_of(step, layer), n);
        Eigen::VectorXd normal(F);
        for (Eigen::Index f = 0; f < F; ++f) normal[f] = rng.normal();
        // The mean itself and the best so far take part, so that a layer never loses what was found.
        Eigen::VectorXd drawn = search.mean + factor.triangularView<Eigen::Lower>() * normal;
        if (n == 0) drawn = search.mean;
        if (n == 1) drawn = best;
        const std::span<double> state(particles.states.row(column).data(), D);
        std::copy(prior.mean.begin(), prior.mean.end(), state.begin());
        for (Eigen::Index f = 0; f < F; ++f) state[free[f]] += drawn[f] * prior.deviation[free[f]];
        std::vector<double> valid(state.begin(), state.end());
        keep_valid(valid);
        for (Eigen::Index f = 0; f < F; ++f) {
          // Limits move an offset; whole turns of a wrapped angle do not.
          const double moved = valid[free[f]] - state[free[f]];
          if (std::abs(moved) < kHalfTurn) drawn[f] += moved / prior.deviation[free[f]];
        }
        std::copy(valid.begin(), valid.end(), state.begin());
        offsets.col(column) = drawn;
      }
    });
    log_likelihood(particles.states, particles.log_weights);
    for (int n = 0; n < N; ++n) {
      double& value = particles.log_weights[static_cast<size_t>(n)];
      check(!std::isnan(value), "adaptive_search: log-likelihood of particle {} is not a number", n);
      value -= 0.5 * offsets.col(n).squaredNorm();
    }
    if (layer + 1 == options.num_layers) break;

    std::vector<int> order(static_cast<size_t>(N));
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
      return particles.log_weights[static_cast<size_t>(a)] > particles.log_weights[static_cast<size_t>(b)];
    });
    if (const double value = particles.log_weights[static_cast<size_t>(order[0])]; value > best_value) {
      best_value = value;
      best = offsets.col(order[0]);
    }
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(F);
    Eigen::MatrixXd scatter = Eigen::MatrixXd::Zero(F, F);
    for (Eigen::Index i = 0; i < weights.size(); ++i) {
      const auto elite = offsets.col(order[static_cast<size_t>(i)]);
      const Eigen::VectorXd step_taken = elite - search.mean;  // about the old mean: so that the search can accelerate
      mean += weights[i] * elite;
      scatter.noalias() += weights[i] * step_taken * step_taken.transpose();
    }
    search.mean = mean;
    search.covariance = (1 - rate) * search.covariance + rate * scatter;
    search.covariance.diagonal().array() += 1e-12;  // stays positive definite when all elites agree
  }
  const double exponent = annealing_exponent(particles.log_weights, options.survival_rate, 1.0);
  report.layer_exponent.push_back(exponent);
  for (double& value : particles.log_weights) value *= exponent;
  const Normalisation normalisation = normalise_log_weights(particles.log_weights);
  report.effective_sample_size = normalisation.effective_sample_size;
  report.degenerate = normalisation.degenerate;
  return particles;
}

}  // namespace silpose
