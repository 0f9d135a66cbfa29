#include "silpose/filter/estimate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "silpose/base/rng.h"

namespace silpose {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kSecond[] = {1};

StateBatch rows(std::initializer_list<std::initializer_list<double>> values) {
  StateBatch states(static_cast<Eigen::Index>(values.size()), static_cast<Eigen::Index>(values.begin()->size()));
  Eigen::Index i = 0;
  for (const auto& row : values) {
    Eigen::Index d = 0;
    for (const double value : row) states(i, d++) = value;
    ++i;
  }
  return states;
}

TEST(WeightedMean, OfAHandWorkedSet) {
  const StateBatch states = rows({{0, 10}, {4, 20}});
  const std::vector<double> mean = weighted_mean(states, std::vector{3.0, 1.0});
  EXPECT_DOUBLE_EQ(mean[0], 1);
  EXPECT_DOUBLE_EQ(mean[1], 12.5);
  const std::vector<double> deviation = weighted_deviation(states, std::vector{3.0, 1.0});
  EXPECT_DOUBLE_EQ(deviation[0], std::sqrt(0.75 * 1 + 0.25 * 9));
}

TEST(WeightedMean, GoesTheShortWayAroundACircle) {
  const StateBatch states = rows({{0, kPi - 0.1}, {0, -kPi + 0.1}, {0, 3 * kPi}});
  const std::vector<double> weight(3, 1.0 / 3);
  EXPECT_NEAR(std::abs(weighted_mean(states, weight, kSecond)[1]), kPi, 1e-12);
  EXPECT_NEAR(weighted_deviation(states, weight, kSecond)[1], 0.1 * std::sqrt(2.0 / 3), 1e-12);
  EXPECT_NEAR(weighted_mean(states, weight)[1], kPi, 1e-12);  // as numbers: (pi - pi + 3 pi) / 3
}

TEST(WeightedMean, OfNoDirectionIsTheHeaviest) {
  const StateBatch states = rows({{0, 0.5}, {0, 0.5 + kPi}});
  EXPECT_NEAR(weighted_mean(states, std::vector{0.5, 0.5}, kSecond)[1], 0.5, 1e-12);
}

TEST(WeightedMean, RefusesBadInput) {
  const StateBatch states = rows({{0, 1}, {2, 3}});
  const int beyond[] = {2};
  EXPECT_THROW((void)weighted_mean(states, std::vector{1.0}), std::invalid_argument);
  EXPECT_THROW((void)weighted_mean(states, std::vector{0.0, 0.0}), std::invalid_argument);
  EXPECT_THROW((void)weighted_mean(states, std::vector{1.0, -1.0}), std::invalid_argument);
  EXPECT_THROW((void)weighted_mean(states, std::vector{1.0, 1.0}, beyond), std::invalid_argument);
}

TEST(ModeIndex, IsTheFirstOfTheHeaviest) {
  EXPECT_EQ(mode_index(std::vector{0.1, 0.4, 0.4, 0.1}), 1);
  EXPECT_THROW((void)mode_index({}), std::invalid_argument);
}

// Two hypotheses: the mean lies between them, the cluster estimate on the heavier one.
TEST(ClusterEstimate, ChoosesOneOfTwoHypotheses) {
  StateBatch states(400, 2);
  std::vector<double> weight(400);
  Rng rng(1);
  for (Eigen::Index i = 0; i < 400; ++i) {
    const double centre = i < 200 ? 3.1 : 0.0;  // the first lies across the seam of the circle
    states(i, 0) = centre + 0.1 * rng.normal();
    states(i, 1) = centre + 0.1 * rng.normal();
    weight[static_cast<size_t>(i)] = (i < 200 ? 0.7 : 0.3) * std::exp(-std::pow(states(i, 0) - centre, 2) * 20) / 200;
  }
  const Cluster cluster = cluster_estimate(states, weight, std::vector{1.0, 1.0}, 0.4, kSecond);
  EXPECT_NEAR(cluster.mean[0], 3.1, 0.05);
  EXPECT_NEAR(std::remainder(cluster.mean[1] - 3.1, 2 * kPi), 0, 0.05);
  EXPECT_NEAR(cluster.weight, 0.7, 0.05);
  EXPECT_LT(weighted_mean(states, weight)[0], 2.6);
}

TEST(ClusterEstimate, IsTheMeanWhenAllAgree) {
  const StateBatch states = rows({{1, 5}, {2, 7}});
  const Cluster cluster = cluster_estimate(states, std::vector{0.5, 0.5}, std::vector{1.0, 0.0}, 100);
  EXPECT_NEAR(cluster.mean[0], 1.5, 0.01);
  EXPECT_NEAR(cluster.mean[1], 6, 0.02);
  EXPECT_DOUBLE_EQ(cluster.weight, 1);
  EXPECT_THROW((void)cluster_estimate(states, std::vector{0.5, 0.5}, std::vector{0.0, 0.0}, 1), std::invalid_argument);
  EXPECT_THROW((void)cluster_estimate(states, std::vector{0.5, 0.5}, std::vector{1.0, 1.0}, 0), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
