#include "silpose/filter/adaptive_search.h"

#include <gtest/gtest.h>

#include <cmath>

#include "silpose/base/parallel.h"
#include "silpose/filter/estimate.h"

namespace silpose {
namespace {

void no_limits(std::span<double>) {}

// Log of a Gaussian about `centre` with deviation `sigma` in every column.
LogLikelihood bump(std::vector<double> centre, double sigma) {
  return [centre = std::move(centre), sigma](const StateBatch& states, std::span<double> out) {
    for (Eigen::Index n = 0; n < states.rows(); ++n) {
      double sum = 0;
      for (Eigen::Index d = 0; d < states.cols(); ++d) {
        const double off = (states(n, d) - centre[static_cast<size_t>(d)]) / sigma;
        sum += off * off;
      }
      out[static_cast<size_t>(n)] = -0.5 * sum;
    }
  };
}

TEST(AdaptiveSearch, FindsThePosteriorMeanOfAGaussian) {
  const GaussianPrior prior{{0, 1, -1}, {0.5, 0.5, 0.5}};
  FilterReport report;
  const ParticleSet particles =
      adaptive_search(prior, {.num_particles = 400, .num_layers = 12}, 0, no_limits, bump({1, 1, 0}, 0.5), report);
  const auto mean = weighted_mean(particles.states, particles.weights());
  // Prior and likelihood are equally sure: half way.
  EXPECT_NEAR(mean[0], 0.5, 0.05);
  EXPECT_NEAR(mean[1], 1, 0.05);
  EXPECT_NEAR(mean[2], -0.5, 0.05);
  EXPECT_GT(report.effective_sample_size, 90);
}

TEST(AdaptiveSearch, FollowsANarrowValleyAcrossColumns) {
  // Only the sum of the columns is seen sharply, their difference faintly: noise without covariance gets stuck.
  const LogLikelihood valley = [](const StateBatch& states, std::span<double> out) {
    for (Eigen::Index n = 0; n < states.rows(); ++n) {
      const double sum = states(n, 0) + states(n, 1), difference = states(n, 0) - states(n, 1) - 2;
      out[static_cast<size_t>(n)] = -0.5 * (1e6 * sum * sum + 100 * difference * difference);
    }
  };
  FilterReport report;
  const ParticleSet particles = adaptive_search({{0, 0}, {1, 1}}, {.num_particles = 60, .num_layers = 25}, 0, no_limits,
                                                valley, report);
  const auto mean = weighted_mean(particles.states, particles.weights());
  EXPECT_NEAR(mean[0], 1, 0.1);
  EXPECT_NEAR(mean[1], -1, 0.1);
}

TEST(AdaptiveSearch, HoldsColumnsWithoutDeviationAndKeepsLimits) {
  FilterReport report;
  const KeepValid limit = [](std::span<double> state) { state[1] = std::min(state[1], 0.3); };
  const ParticleSet particles =
      adaptive_search({{5, 0}, {0, 1}}, {.num_particles = 50, .num_layers = 5}, 0, limit, bump({0, 2}, 0.2), report);
  for (Eigen::Index n = 0; n < 50; ++n) {
    EXPECT_EQ(particles.states(n, 0), 5);
    EXPECT_LE(particles.states(n, 1), 0.3);
  }
  EXPECT_NEAR(weighted_mean(particles.states, particles.weights())[1], 0.3, 0.02);
}

TEST(AdaptiveSearch, IsTheSameOnAnyNumberOfThreadsAndDiffersBySeedAndStep) {
  const auto run = [](int threads, uint64_t seed, uint64_t step) {
    const ThreadLimit limit(threads);
    FilterReport report;
    return adaptive_search({{0, 0}, {1, 1}}, {.num_particles = 100, .num_layers = 4, .seed = seed}, step, no_limits,
                           bump({1, 1}, 0.1), report);
  };
  EXPECT_EQ(run(1, 1, 0).states, run(2, 1, 0).states);
  EXPECT_NE(run(1, 1, 0).states, run(1, 2, 0).states);
  EXPECT_NE(run(1, 1, 0).states, run(1, 1, 1).states);
}

TEST(AdaptiveSearch, RefusesWhatCannotWork) {
  FilterReport report;
  const auto flat = [](const StateBatch&, std::span<double> out) { std::fill(out.begin(), out.end(), 0); };
  const auto nan = [](const StateBatch&, std::span<double> out) { std::fill(out.begin(), out.end(), std::nan("")); };
  EXPECT_THROW(adaptive_search({{0}, {1, 2}}, {}, 0, no_limits, flat, report), std::invalid_argument);
  EXPECT_THROW(adaptive_search({{0}, {1}}, {.num_particles = 3}, 0, no_limits, flat, report), std::invalid_argument);
  EXPECT_THROW(adaptive_search({{0}, {1}}, {.num_layers = 0}, 0, no_limits, flat, report), std::invalid_argument);
  EXPECT_THROW(adaptive_search({{0}, {1}}, {}, 0, no_limits, nan, report), std::invalid_argument);
  EXPECT_NO_THROW(adaptive_search({{0}, {1}}, {.num_particles = 4, .num_layers = 1}, 0, no_limits, flat, report));
}

}  // namespace
}  // namespace silpose
