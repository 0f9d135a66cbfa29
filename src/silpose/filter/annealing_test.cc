#include "silpose/filter/annealing.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>

#include "silpose/base/parallel.h"
#include "silpose/base/rng.h"
#include "silpose/filter/annealed_filter.h"
#include "silpose/filter/estimate.h"

namespace silpose {
namespace {

constexpr double kImpossible = -std::numeric_limits<double>::infinity();

double survivors(std::vector<double> log_likelihood, double exponent) {
  for (double& value : log_likelihood) value = value == kImpossible ? value : value * exponent;
  return effective_sample_size(weights_from_log_weights(log_likelihood));
}

TEST(AnnealingExponent, KeepsTheChosenShare) {
  Rng rng(1);
  for (const double scale : {1e-3, 1.0, 1e5}) {
    std::vector<double> log_likelihood(500);
    for (double& value : log_likelihood) value = -1e4 + scale * rng.normal();
    for (const double survival_rate : {0.05, 0.5, 0.9}) {
      const double exponent = annealing_exponent(log_likelihood, survival_rate, 1e6);
      EXPECT_NEAR(survivors(log_likelihood, exponent) / 500, survival_rate, 1e-6) << scale;
    }
  }
}

TEST(AnnealingExponent, OfTwoParticlesByHand) {
  // Weights 1 and q: (1 + q)^2 / (1 + q^2) = 1.6 at q = 1/3, so exponent = log 3 / 2.
  EXPECT_NEAR(annealing_exponent(std::vector{0.0, -2.0}, 0.8, 100), std::log(3.0) / 2, 1e-9);
}

TEST(AnnealingExponent, StopsAtTheLargest) {
  EXPECT_EQ(annealing_exponent(std::vector{-3.0, -3.0, -3.0}, 0.5, 10), 10);
  EXPECT_EQ(annealing_exponent(std::vector{-3.0, -3.1}, 0.5, 2), 2);
  EXPECT_EQ(annealing_exponent(std::vector{kImpossible, kImpossible}, 0.5, 2), 2);
}

TEST(AnnealingExponent, LeavesTheImpossibleOut) {
  EXPECT_NEAR(annealing_exponent(std::vector{0.0, kImpossible, -2.0, kImpossible}, 0.8, 100), std::log(3.0) / 2, 1e-9);
}

TEST(AnnealingExponent, RefusesBadInput) {
  EXPECT_THROW((void)annealing_exponent(std::vector{0.0}, 0, 1), std::invalid_argument);
  EXPECT_THROW((void)annealing_exponent(std::vector{0.0}, 1.1, 1), std::invalid_argument);
  EXPECT_THROW((void)annealing_exponent(std::vector{std::nan("")}, 0.5, 1), std::invalid_argument);
}

TEST(AnnealingNoiseScale, HalvesTheVariance) {
  EXPECT_DOUBLE_EQ(annealing_noise_scale(0, 0.5), 1);
  EXPECT_NEAR(std::pow(annealing_noise_scale(3, 0.5), 2), 0.125, 1e-12);
}

TEST(Crossover, TakesWholeBlocksFromOneParent) {
  StateBatch parents(2, 5);
  parents << 1, 1, 1, 1, 1, 2, 2, 2, 2, 2;
  const std::vector<std::vector<int>> blocks = {{1, 2}, {4}};
  const std::vector<int> first(400, 0), second(400, 1);
  const StateBatch children = crossover(parents, first, second, blocks, 0.25, 1, 1);
  for (Eigen::Index i = 0; i < children.rows(); ++i) {
    EXPECT_EQ(children(i, 0), 1);
    EXPECT_EQ(children(i, 3), 1);
    EXPECT_EQ(children(i, 1), children(i, 2));
  }
  EXPECT_NEAR(static_cast<double>((children.col(1).array() == 2).count()), 100, 40);
  EXPECT_NEAR(static_cast<double>((children.col(4).array() == 2).count()), 100, 40);
  EXPECT_GT((children.col(1).array() != children.col(4).array()).count(), 50);
  const std::vector<int> beyond(400, 2);
  EXPECT_THROW((void)crossover(parents, first, beyond, blocks, 0.5, 1, 1), std::invalid_argument);
  EXPECT_THROW((void)crossover(parents, first, second, std::vector<std::vector<int>>{{5}}, 0.5, 1, 1),
               std::invalid_argument);
}

// Each block keeps its mean and deviation, blocks lose their correlation with each other.
TEST(Crossover, KeepsMarginals) {
  constexpr int kParticles = 4000;
  StateBatch parents(kParticles, 3);
  for (int i = 0; i < kParticles; ++i) {
    Rng rng(4, 0, static_cast<uint64_t>(i));
    const double shared = rng.normal();
    parents.row(i) << shared, shared + 0.1 * rng.normal(), shared + 0.1 * rng.normal();
  }
  std::vector<int> first(kParticles), second(kParticles);
  std::iota(first.begin(), first.end(), 0);
  Rng rng(9);
  for (int& parent : second) parent = static_cast<int>(rng.index(kParticles));
  const StateBatch children = crossover(parents, first, second, std::vector<std::vector<int>>{{1}, {2}}, 0.5, 1, 1);
  const std::vector<double> weight(kParticles, 1.0 / kParticles);
  const std::vector<double> mean = weighted_mean(parents, weight), new_mean = weighted_mean(children, weight);
  const std::vector<double> deviation = weighted_deviation(parents, weight);
  const std::vector<double> new_deviation = weighted_deviation(children, weight);
  for (size_t d = 0; d < 3; ++d) {
    EXPECT_NEAR(new_mean[d], mean[d], 0.05);
    EXPECT_NEAR(new_deviation[d], deviation[d], 0.05);
  }
  EXPECT_LT((children.col(1).array() * children.col(2).array()).mean(), 0.7);
  EXPECT_GT((parents.col(1).array() * parents.col(2).array()).mean(), 0.9);
}

const Diffuse kDiffuse = [](StateBatch& states, std::span<const double> deviation, uint64_t stream) {
  parallel_for(static_cast<size_t>(states.rows()), 32, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      Rng rng(1, stream, i);
      for (size_t d = 0; d < deviation.size(); ++d) {
        states(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(d)) += deviation[d] * rng.normal();
      }
    }
  });
};

// A wide hill at 0 and a higher, narrow one at 3 in every column.
const LogLikelihood kTwoPeaks = [](const StateBatch& states, std::span<double> result) {
  for (size_t i = 0; i < result.size(); ++i) {
    double sum = 0;
    for (const double x : states.row(static_cast<Eigen::Index>(i))) {
      sum += std::log(std::exp(-0.5 * x * x) + 5 * std::exp(-0.5 * (x - 3) * (x - 3) / 0.04));
    }
    result[i] = 20 * sum;
  }
};

AnnealedFilter two_peaks_filter(AnnealedFilterOptions options, int num_particles = 200) {
  StateBatch states(num_particles, 4);
  for (Eigen::Index i = 0; i < num_particles; ++i) {
    Rng rng(2, 0, static_cast<uint64_t>(i));
    for (Eigen::Index d = 0; d < 4; ++d) states(i, d) = rng.normal();
  }
  options.deviation.assign(4, 1.0);
  return AnnealedFilter(states, make_resampler("systematic").value(), std::move(options));
}

// The layers alone: equal weights, which resampling leaves as they are, and nothing moves.
FilterReport search(AnnealedFilter& filter, const Diffuse& diffuse, const LogLikelihood& log_likelihood) {
  return filter.step([](StateBatch&, uint64_t) {}, diffuse, log_likelihood);
}

TEST(AnnealedFilter, FindsTheBetterOfTwoModes) {
  AnnealedFilter filter = two_peaks_filter({.num_layers = 12, .blocks = {{0}, {1}, {2}, {3}}});
  const FilterReport report = search(filter, kDiffuse, kTwoPeaks);
  EXPECT_EQ(report.layer_exponent.size(), 12u);
  EXPECT_NEAR(report.effective_sample_size, 100, 1);
  const ParticleSet& particles = filter.particles();
  for (const double x : weighted_mean(particles.states, particles.weights())) EXPECT_NEAR(x, 3, 0.3);
  for (const double x : particles.states.row(mode_index(particles.log_weights))) EXPECT_NEAR(x, 3, 0.15);
}

TEST(AnnealedFilter, AdaptiveNoiseLetsSettledColumnsRest) {
  AnnealedFilter filter = two_peaks_filter({.num_layers = 6, .adaptive_noise = true});
  int layer = 0;
  search(
      filter,
      [&](StateBatch& states, std::span<const double> deviation, uint64_t stream) {
        for (const double value : deviation) EXPECT_LE(value, 1.0);
        if (++layer >= 3) {
          EXPECT_LT(deviation[0], 0.3 * deviation[1]);
        }
        kDiffuse(states, deviation, stream);
      },
      [](const StateBatch& states, std::span<double> result) {
        for (size_t i = 0; i < result.size(); ++i) {
          const auto x = states.row(static_cast<Eigen::Index>(i));
          result[i] = -1e4 * x[0] * x[0] - 0.01 * x[1] * x[1];
        }
      });
  EXPECT_EQ(layer, 5);
}

TEST(AnnealedFilter, NeverLosesTheBest) {
  double best = -1e300;
  const LogLikelihood watched = [&](const StateBatch& states, std::span<double> result) {
    kTwoPeaks(states, result);
    const double now = *std::max_element(result.begin(), result.end());
    EXPECT_GE(now, best);
    best = now;
  };
  AnnealedFilter filter = two_peaks_filter({.num_layers = 8}, 40);
  search(filter, kDiffuse, watched);
}

TEST(AnnealedFilter, FollowsAMovingPeak) {
  AnnealedFilter filter = two_peaks_filter({.num_layers = 6});
  for (int t = 0; t < 10; ++t) {
    filter.step([](StateBatch& states, uint64_t stream) { kDiffuse(states, std::vector(4, 0.3), stream); }, kDiffuse,
                [t](const StateBatch& states, std::span<double> result) {
                  for (size_t i = 0; i < result.size(); ++i) {
                    result[i] = -50 * (states.row(static_cast<Eigen::Index>(i)).array() - 0.3 * t).square().sum();
                  }
                });
  }
  for (const double x : weighted_mean(filter.particles().states, filter.particles().weights()))
    EXPECT_NEAR(x, 2.7, 0.1);
}

TEST(AnnealedFilter, IsTheSameOnAnyNumberOfThreads) {
  const auto run = [](int num_threads) {
    const ThreadLimit limit(num_threads);
    AnnealedFilter filter = two_peaks_filter({.num_layers = 5, .blocks = {{0, 1}, {2, 3}}});
    search(filter, kDiffuse, kTwoPeaks);
    return filter.particles();
  };
  const ParticleSet one = run(1), two = run(2);
  EXPECT_TRUE((one.states.array() == two.states.array()).all());
  EXPECT_EQ(one.log_weights, two.log_weights);
}

TEST(AnnealedFilter, RefusesOptionsOutOfRange) {
  EXPECT_THROW(two_peaks_filter({.num_layers = 0}), std::invalid_argument);
  EXPECT_THROW(two_peaks_filter({.num_layers = kMaxLayers}), std::invalid_argument);
  EXPECT_THROW(two_peaks_filter({.survival_rate = 0}), std::invalid_argument);
  EXPECT_THROW(two_peaks_filter({.exchange = 2}), std::invalid_argument);
  EXPECT_THROW(AnnealedFilter(StateBatch::Zero(3, 2), make_resampler("systematic").value(), {.deviation = {1.0}}),
               std::invalid_argument);
}

}  // namespace
}  // namespace silpose
