#include "silpose/filter/log_weights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

namespace silpose {
namespace {

constexpr double kImpossible = -std::numeric_limits<double>::infinity();

TEST(LogSumExp, IsSafeFarBelowZero) {
  EXPECT_NEAR(log_sum_exp(std::vector{-1e4, -1e4}), -1e4 + std::log(2.0), 1e-9);
  EXPECT_NEAR(log_sum_exp(std::vector{-1e4, -1e4 - 2000}), -1e4, 1e-9);
  EXPECT_NEAR(log_sum_exp(std::vector{900.0, 900.0}), 900 + std::log(2.0), 1e-9);
  EXPECT_NEAR(log_sum_exp(std::vector{std::log(1.0), std::log(2.0), kImpossible}), std::log(3.0), 1e-12);
}

TEST(LogSumExp, IsMinusInfinityForNothing) {
  EXPECT_EQ(log_sum_exp({}), kImpossible);
  EXPECT_EQ(log_sum_exp(std::vector{kImpossible, kImpossible}), kImpossible);
}

TEST(LogSumExp, RefusesWhatIsNoLikelihood) {
  EXPECT_THROW((void)log_sum_exp(std::vector{0.0, std::nan("")}), std::invalid_argument);
  EXPECT_THROW((void)log_sum_exp(std::vector{0.0, -kImpossible}), std::invalid_argument);
}

TEST(NormaliseLogWeights, GivesWeightsOfOneToThree) {
  std::vector<double> log_weight = {-5000 + std::log(1.0), -5000 + std::log(3.0)};
  const Normalisation normalisation = normalise_log_weights(log_weight);
  EXPECT_NEAR(std::exp(log_weight[0]), 0.25, 1e-12);
  EXPECT_NEAR(std::exp(log_weight[1]), 0.75, 1e-12);
  EXPECT_NEAR(normalisation.log_sum, -5000 + std::log(4.0), 1e-9);
  EXPECT_NEAR(normalisation.effective_sample_size, 1 / (0.0625 + 0.5625), 1e-12);
  EXPECT_FALSE(normalisation.degenerate);
}

TEST(NormaliseLogWeights, AllImpossibleBecomesUniformWithAFlag) {
  std::vector<double> log_weight(4, kImpossible);
  const Normalisation normalisation = normalise_log_weights(log_weight);
  EXPECT_TRUE(normalisation.degenerate);
  EXPECT_DOUBLE_EQ(normalisation.effective_sample_size, 4);
  for (const double value : log_weight) EXPECT_DOUBLE_EQ(value, -std::log(4.0));
  EXPECT_EQ(weights_from_log_weights(std::vector(2, kImpossible)), (std::vector{0.5, 0.5}));
}

TEST(NormaliseLogWeights, RefusesNoWeights) {
  std::vector<double> none;
  EXPECT_THROW(normalise_log_weights(none), std::invalid_argument);
}

TEST(EffectiveSampleSize, CountsEqualWeights) {
  EXPECT_DOUBLE_EQ(effective_sample_size(std::vector(10, 0.1)), 10);
  EXPECT_DOUBLE_EQ(effective_sample_size(std::vector{0.0, 1.0, 0.0}), 1);
  EXPECT_DOUBLE_EQ(effective_sample_size(std::vector{0.5, 0.5, 0.0, 0.0}), 2);
  EXPECT_NEAR(effective_sample_size(std::vector{0.5, 0.25, 0.25}), 1 / 0.375, 1e-12);
  EXPECT_DOUBLE_EQ(effective_sample_size(std::vector{0.0, 0.0}), 0);
}

}  // namespace
}  // namespace silpose
