#include "silpose/filter/estimate.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "silpose/base/check.h"

namespace silpose {
namespace {

constexpr double kTurn = 2 * std::numbers::pi;  // [definition]
constexpr double kNoDirection = 1e-9;           // [guess] a mean unit vector shorter than this is rounding

double shorter_way(double difference) { return std::remainder(difference, kTurn); }

std::vector<bool> circular_flags(const StateBatch& states, std::span<const double> weight,
                                 std::span<const int> circular) {
  check(static_cast<size_t>(states.rows()) == weight.size(), "estimate: {} states, {} weights", states.rows(),
        weight.size());
  double sum = 0;
  for (const double w : weight) {
    check(w >= 0, "estimate: weight {}", w);
    sum += w;
  }
  check(sum > 0, "estimate: no weight is positive");
  std::vector<bool> flags(static_cast<size_t>(states.cols()), false);
  for (const int column : circular) {
    check(column >= 0 && column < states.cols(), "estimate: circular column {} of {}", column, states.cols());
    flags[static_cast<size_t>(column)] = true;
  }
  return flags;
}

double linear_mean(const StateBatch& states, std::span<const double> weight, Eigen::Index column) {
  double sum = 0, total = 0;
  for (Eigen::Index i = 0; i < states.rows(); ++i) {
    sum += weight[static_cast<size_t>(i)] * states(i, column);
    total += weight[static_cast<size_t>(i)];
  }
  return sum / total;
}

double circular_mean(const StateBatch& states, std::span<const double> weight, Eigen::Index column) {
  double sine = 0, cosine = 0, total = 0;
  for (Eigen::Index i = 0; i < states.rows(); ++i) {
    const double w = weight[static_cast<size_t>(i)];
    sine += w * std::sin(states(i, column));
    cosine += w * std::cos(states(i, column));
    total += w;
  }
  if (std::hypot(sine, cosine) < kNoDirection * total) return shorter_way(states(mode_index(weight), column));
  return std::atan2(sine, cosine);
}

std::vector<double> mean_of(const StateBatch& states, std::span<const double> weight, const std::vector<bool>& wraps) {
  std::vector<double> mean(wraps.size());
  for (size_t d = 0; d < mean.size(); ++d) {
    const auto column = static_cast<Eigen::Index>(d);
    mean[d] = wraps[d] ? circular_mean(states, weight, column) : linear_mean(states, weight, column);
  }
  return mean;
}

}  // namespace

std::vector<double> weighted_mean(const StateBatch& states, std::span<const double> weight,
                                  std::span<const int> circular) {
  return mean_of(states, weight, circular_flags(states, weight, circular));
}

std::vector<double> weighted_deviation(const StateBatch& states, std::span<const double> weight,
                                       std::span<const int> circular) {
  const std::vector<bool> wraps = circular_flags(states, weight, circular);
  const std::vector<double> mean = mean_of(states, weight, wraps);
  std::vector<double> deviation(mean.size());
  for (size_t d = 0; d < mean.size(); ++d) {
    double sum = 0, total = 0;
    for (Eigen::Index i = 0; i < states.rows(); ++i) {
      double difference = states(i, static_cast<Eigen::Index>(d)) - mean[d];
      if (wraps[d]) difference = shorter_way(difference);
      sum += weight[static_cast<size_t>(i)] * difference * difference;
      total += weight[static_cast<size_t>(i)];
    }
    deviation[d] = std::sqrt(sum / total);
  }
  return deviation;
}

int mode_index(std::span<const double> weight) {
  check(!weight.empty(), "mode_index: no particles");
  return static_cast<int>(std::max_element(weight.begin(), weight.end()) - weight.begin());
}

Cluster cluster_estimate(const StateBatch& states, std::span<const double> weight, std::span<const double> scale,
                         double bandwidth, std::span<const int> circular) {
  const std::vector<bool> wraps = circular_flags(states, weight, circular);
  check(scale.size() == wraps.size(), "cluster_estimate: {} scales for {} columns", scale.size(), wraps.size());
  check(bandwidth > 0, "cluster_estimate: bandwidth {}", bandwidth);
  int num_counted = 0;
  for (const double s : scale) {
    check(s >= 0, "cluster_estimate: scale {}", s);
    num_counted += s > 0 ? 1 : 0;
  }
  check(num_counted > 0, "cluster_estimate: every scale is 0");

  // (distance / bandwidth)^2 of each state [N] to `centre`.
  std::vector<double> squared(weight.size());
  const auto measure = [&](const std::vector<double>& centre) {
    for (size_t i = 0; i < squared.size(); ++i) {
      double sum = 0;
      for (size_t d = 0; d < centre.size(); ++d) {
        if (scale[d] <= 0) continue;
        double difference = states(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(d)) - centre[d];
        if (wraps[d]) difference = shorter_way(difference);
        sum += (difference / scale[d]) * (difference / scale[d]);
      }
      squared[i] = sum / num_counted / (bandwidth * bandwidth);
    }
  };

  constexpr int kMaxShifts = 50;    // [guess]
  constexpr double kAtRest = 1e-4;  // [guess] of the bandwidth
  Cluster cluster;
  const int start = mode_index(weight);
  cluster.mean.assign(states.row(start).begin(), states.row(start).end());
  std::vector<double> kernel(weight.size());
  for (int shift = 0; shift < kMaxShifts; ++shift) {
    measure(cluster.mean);
    for (size_t i = 0; i < kernel.size(); ++i) kernel[i] = weight[i] * std::exp(-0.5 * squared[i]);
    const std::vector<double> next = mean_of(states, kernel, wraps);
    double moved = 0;
    for (size_t d = 0; d < next.size(); ++d) {
      const double difference = wraps[d] ? shorter_way(next[d] - cluster.mean[d]) : next[d] - cluster.mean[d];
      if (scale[d] > 0) moved = std::max(moved, std::abs(difference) / scale[d]);
    }
    cluster.mean = next;
    if (moved < kAtRest * bandwidth) break;
  }
  measure(cluster.mean);
  double inside = 0, total = 0;
  for (size_t i = 0; i < weight.size(); ++i) {
    if (squared[i] <= 1) inside += weight[i];
    total += weight[i];
  }
  cluster.weight = inside / total;
  return cluster;
}

}  // namespace silpose
