#include "silpose/filter/annealing.h"

#include <cmath>
#include <limits>

#include "silpose/base/check.h"
#include "silpose/base/rng.h"
#include "silpose/filter/log_weights.h"

namespace silpose {
namespace {

// Keeps these draws apart from the noise of the same layer. [definition]
constexpr uint64_t kCrossoverStream = 0xc2055ba5e0d5a17du;

}  // namespace

double annealing_exponent(std::span<const double> log_likelihood, double survival_rate, double max_exponent) {
  check(survival_rate > 0 && survival_rate <= 1, "survival rate {}: must be in (0, 1]", survival_rate);
  check(max_exponent > 0, "annealing: largest exponent {}", max_exponent);
  std::vector<double> alive;
  const double log_sum = log_sum_exp(log_likelihood);  // refuses NaN
  for (const double value : log_likelihood) {
    if (value > -std::numeric_limits<double>::infinity()) alive.push_back(value - log_sum);
  }
  if (alive.empty()) return max_exponent;
  const double wanted = survival_rate * static_cast<double>(alive.size());
  std::vector<double> scaled(alive.size());
  const auto survivors = [&](double exponent) {
    for (size_t i = 0; i < alive.size(); ++i) scaled[i] = exponent * alive[i];
    return effective_sample_size(weights_from_log_weights(scaled));
  };
  if (survivors(max_exponent) >= wanted) return max_exponent;
  // The effective sample size falls as the exponent rises: 0 keeps all, max_exponent too few. The exponent may be many
  // orders below the largest, so bisect its logarithm once it is bracketed from below.
  double low = max_exponent;
  double high = max_exponent;
  while (low > 1e-300 && survivors(low) < wanted) {
    high = low;
    low *= 0.1;
  }
  constexpr int kBisections = 50;  // [guess]
  for (int i = 0; i < kBisections; ++i) {
    const double middle = std::sqrt(low) * std::sqrt(high);
    (survivors(middle) >= wanted ? low : high) = middle;
  }
  return low;
}

double annealing_noise_scale(int layer, double survival_rate) {
  check(layer >= 0, "annealing: layer {}", layer);
  return std::pow(survival_rate, 0.5 * layer);
}

StateBatch crossover(const StateBatch& parents, std::span<const int> first, std::span<const int> second,
                     std::span<const std::vector<int>> blocks, double exchange, uint64_t seed, uint64_t stream) {
  check(first.size() == second.size(), "crossover: {} first parents, {} second", first.size(), second.size());
  check(exchange >= 0 && exchange <= 1, "crossover: exchange {}", exchange);
  for (const std::vector<int>& block : blocks) {
    for (const int column : block) {
      check(column >= 0 && column < parents.cols(), "crossover: column {} of {}", column, parents.cols());
    }
  }
  StateBatch children(static_cast<Eigen::Index>(first.size()), parents.cols());
  for (size_t i = 0; i < first.size(); ++i) {
    check(first[i] >= 0 && first[i] < parents.rows() && second[i] >= 0 && second[i] < parents.rows(),
          "crossover: parents {} and {} of {}", first[i], second[i], parents.rows());
    const auto row = static_cast<Eigen::Index>(i);
    children.row(row) = parents.row(first[i]);
    Rng rng(seed ^ kCrossoverStream, stream, i);
    for (const std::vector<int>& block : blocks) {
      if (rng.uniform() >= exchange) continue;
      for (const int column : block) children(row, column) = parents(second[i], column);
    }
  }
  return children;
}

}  // namespace silpose
