#include "silpose/filter/log_weights.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "silpose/base/check.h"

namespace silpose {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double largest(std::span<const double> log_weight) {
  double result = -kInfinity;
  for (size_t i = 0; i < log_weight.size(); ++i) {
    check(log_weight[i] < kInfinity, "log weight {} is {}", i, log_weight[i]);  // false for NaN, too
    result = std::max(result, log_weight[i]);
  }
  return result;
}

}  // namespace

double log_sum_exp(std::span<const double> log_weight) {
  const double peak = largest(log_weight);
  if (peak == -kInfinity) return peak;
  double sum = 0;
  for (const double value : log_weight) sum += std::exp(value - peak);
  return peak + std::log(sum);
}

Normalisation normalise_log_weights(std::span<double> log_weight) {
  check(!log_weight.empty(), "normalise_log_weights: no weights");
  Normalisation result;
  result.log_sum = log_sum_exp(log_weight);
  if (result.log_sum == -kInfinity) {
    std::fill(log_weight.begin(), log_weight.end(), -std::log(static_cast<double>(log_weight.size())));
    result.degenerate = true;
    result.effective_sample_size = static_cast<double>(log_weight.size());
    return result;
  }
  double sum = 0, sum_of_squares = 0;
  for (double& value : log_weight) {
    value -= result.log_sum;
    const double weight = std::exp(value);
    sum += weight;
    sum_of_squares += weight * weight;
  }
  result.effective_sample_size = sum * sum / sum_of_squares;
  return result;
}

std::vector<double> weights_from_log_weights(std::span<const double> log_weight) {
  const double log_sum = log_sum_exp(log_weight);
  if (log_sum == -kInfinity) {
    return std::vector<double>(log_weight.size(), 1 / static_cast<double>(log_weight.size()));
  }
  std::vector<double> weight(log_weight.size());
  for (size_t i = 0; i < weight.size(); ++i) weight[i] = std::exp(log_weight[i] - log_sum);
  return weight;
}

double effective_sample_size(std::span<const double> weight) {
  double sum = 0, sum_of_squares = 0;
  for (const double w : weight) {
    sum += w;
    sum_of_squares += w * w;
  }
  return sum_of_squares > 0 ? sum * sum / sum_of_squares : 0;
}

}  // namespace silpose
