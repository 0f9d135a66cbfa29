#include "silpose/filter/particle_filter.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "silpose/base/parallel.h"
#include "silpose/filter/estimate.h"

namespace silpose {
namespace {

std::shared_ptr<const Resampler> resampler(const std::string& name, double regenerate_fraction = 0) {
  return make_resampler(name, regenerate_fraction).value();
}

StateBatch normal_states(int num_particles, int dimension, uint64_t seed, double deviation = 1) {
  StateBatch states(num_particles, dimension);
  for (Eigen::Index i = 0; i < num_particles; ++i) {
    Rng rng(seed, 1u << 30, static_cast<uint64_t>(i));
    for (Eigen::Index d = 0; d < dimension; ++d) states(i, d) = deviation * rng.normal();
  }
  return states;
}

// x' = F x + noise, y = H x + noise, all Gaussian: a case with an exact answer.
struct LinearModel {
  Eigen::MatrixXd f, h;
  Eigen::VectorXd process_deviation;
  double measurement_deviation;

  Propagate propagate(uint64_t seed) const {
    return [=, this](StateBatch& states, uint64_t stream) {
      parallel_for(static_cast<size_t>(states.rows()), 64, [&](size_t begin, size_t end) {
        for (size_t i = begin; i < end; ++i) {
          Rng rng(seed, stream, i);
          Eigen::VectorXd x = f * states.row(static_cast<Eigen::Index>(i)).transpose();
          for (Eigen::Index d = 0; d < x.size(); ++d) x[d] += process_deviation[d] * rng.normal();
          states.row(static_cast<Eigen::Index>(i)) = x.transpose();
        }
      });
    };
  }
  LogLikelihood log_likelihood(double y) const {
    return [=, this](const StateBatch& states, std::span<double> result) {
      for (size_t i = 0; i < result.size(); ++i) {
        const double error = (y - h.row(0).dot(states.row(static_cast<Eigen::Index>(i)))) / measurement_deviation;
        result[i] = -0.5 * error * error;
      }
    };
  }
};

struct Kalman {
  Eigen::VectorXd mean;
  Eigen::MatrixXd covariance;

  void step(const LinearModel& model, double y) {
    mean = model.f * mean;
    covariance = model.f * covariance * model.f.transpose();
    covariance += model.process_deviation.array().square().matrix().asDiagonal();
    const double innovation =
        (model.h * covariance * model.h.transpose())(0, 0) + std::pow(model.measurement_deviation, 2);
    const Eigen::VectorXd gain = covariance * model.h.transpose() / innovation;
    mean += gain * (y - (model.h * mean)(0, 0));
    covariance -= gain * (model.h * covariance);
  }
};

void expect_agreement(const LinearModel& model, const std::string& scheme, double resample_below) {
  const int dimension = static_cast<int>(model.f.rows());
  ParticleFilter filter(normal_states(20000, dimension, 5), resampler(scheme),
                        {.resample_below = resample_below, .seed = 5});
  Kalman kalman{Eigen::VectorXd::Zero(dimension), Eigen::MatrixXd::Identity(dimension, dimension)};
  for (int t = 0; t < 20; ++t) {
    const double y = 2 * std::sin(0.3 * t);
    filter.step(model.propagate(5), model.log_likelihood(y));
    kalman.step(model, y);
    const std::vector<double> mean = weighted_mean(filter.particles().states, filter.particles().weights());
    const std::vector<double> deviation = weighted_deviation(filter.particles().states, filter.particles().weights());
    for (int d = 0; d < dimension; ++d) {
      const double exact = std::sqrt(kalman.covariance(d, d));
      EXPECT_NEAR(mean[static_cast<size_t>(d)], kalman.mean[d], 0.06 * exact) << "step " << t;
      EXPECT_NEAR(deviation[static_cast<size_t>(d)], exact, 0.05 * exact) << "step " << t;
    }
  }
}

LinearModel random_walk() {
  return {Eigen::MatrixXd::Identity(1, 1), Eigen::MatrixXd::Identity(1, 1), Eigen::VectorXd::Constant(1, 0.5), 0.4};
}

LinearModel constant_velocity() {
  LinearModel model{Eigen::MatrixXd::Identity(2, 2), Eigen::MatrixXd::Zero(1, 2), Eigen::VectorXd(2), 0.5};
  model.f(0, 1) = 1;
  model.h(0, 0) = 1;
  model.process_deviation << 0.2, 0.3;
  return model;
}

TEST(ParticleFilter, AgreesWithAKalmanFilterInOneDimension) {
  expect_agreement(random_walk(), "systematic", 0.5);
  expect_agreement(random_walk(), "comb", 1);
}

TEST(ParticleFilter, AgreesWithAKalmanFilterInTwoDimensions) {
  expect_agreement(constant_velocity(), "systematic", 0.5);
}

TEST(ParticleFilter, IsTheSameOnAnyNumberOfThreads) {
  const auto run = [](int num_threads) {
    const ThreadLimit limit(num_threads);
    ParticleFilter filter(normal_states(500, 2, 3), resampler("systematic"), {.seed = 3});
    for (int t = 0; t < 10; ++t) filter.step(constant_velocity().propagate(3), constant_velocity().log_likelihood(t));
    return filter.particles();
  };
  const ParticleSet one = run(1), two = run(2);
  EXPECT_TRUE((one.states.array() == two.states.array()).all());
  EXPECT_EQ(one.log_weights, two.log_weights);
}

const Propagate kStay = [](StateBatch&, uint64_t) {};

TEST(ParticleFilter, ResamplesWhenTooFewCount) {
  const LogLikelihood favour_first = [](const StateBatch&, std::span<double> result) { result[0] = 1000; };
  ParticleFilter filter(normal_states(10, 1, 1), resampler("systematic"), {.resample_below = 0.5});
  EXPECT_FALSE(filter.step(kStay, favour_first).resampled);
  const double first = filter.particles().states(0, 0);
  const FilterReport report = filter.step(kStay, favour_first);
  EXPECT_TRUE(report.resampled);
  EXPECT_TRUE((filter.particles().states.array() == first).all());

  ParticleFilter never(normal_states(10, 1, 1), resampler("systematic"), {.resample_below = 0});
  for (int t = 0; t < 3; ++t) EXPECT_FALSE(never.step(kStay, favour_first).resampled);
  ParticleFilter always(normal_states(10, 1, 1), resampler("systematic"), {.resample_below = 1});
  EXPECT_TRUE(always.step(kStay, favour_first).resampled);
}

TEST(ParticleFilter, SaysWhenNothingExplainsTheObservation) {
  ParticleFilter filter(normal_states(8, 1, 1), resampler("systematic"));
  const FilterReport report = filter.step(kStay, [](const StateBatch&, std::span<double> result) {
    std::fill(result.begin(), result.end(), -std::numeric_limits<double>::infinity());
  });
  EXPECT_TRUE(report.degenerate);
  EXPECT_DOUBLE_EQ(report.effective_sample_size, 8);
}

TEST(ParticleFilter, CoastingSpreadsAndKeepsWeights) {
  const LinearModel model = random_walk();
  ParticleFilter filter(normal_states(2000, 1, 1), resampler("systematic"));
  filter.step(model.propagate(1), model.log_likelihood(0));
  const std::vector<double> weights = filter.particles().weights();
  double before = weighted_deviation(filter.particles().states, weights)[0];
  for (int t = 0; t < 4; ++t) {
    filter.coast(model.propagate(1));
    const double after = weighted_deviation(filter.particles().states, filter.particles().weights())[0];
    EXPECT_GT(after, before);
    before = after;
  }
  EXPECT_EQ(filter.particles().weights(), weights);
}

TEST(ParticleFilter, RegeneratesWhatTheCombGivesUp) {
  ParticleFilter filter(normal_states(10, 1, 1), resampler("comb", 0.3), {.resample_below = 1});
  const LogLikelihood flat = [](const StateBatch&, std::span<double>) {};
  EXPECT_THROW(filter.step(kStay, flat), std::invalid_argument);
  const Regenerate at_nine = [](StateBatch& states, std::span<const int> new_rows, uint64_t) {
    for (const int row : new_rows) states(row, 0) = 9;
  };
  EXPECT_EQ(filter.step(kStay, flat, at_nine).num_regenerated, 3);
  EXPECT_EQ((filter.particles().states.array() == 9).count(), 3);
}

TEST(ParticleFilter, RefusesNothing) {
  EXPECT_THROW(ParticleFilter(StateBatch(0, 2), resampler("systematic")), std::invalid_argument);
  EXPECT_THROW(ParticleFilter(StateBatch::Zero(2, 2), nullptr), std::invalid_argument);
  EXPECT_THROW(ParticleFilter(StateBatch::Zero(2, 2), resampler("systematic"), {.resample_below = -1}),
               std::invalid_argument);
}

}  // namespace
}  // namespace silpose
