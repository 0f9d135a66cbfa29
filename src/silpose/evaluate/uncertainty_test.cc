#include "silpose/evaluate/uncertainty.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "silpose/base/rng.h"

namespace silpose {
namespace {

using testing::Eq;
using testing::Optional;
using Values = std::vector<double>;

TEST(IntervalCalibrationError, OfAGaussianThatIsClaimedAsItIsIsNothing) {
  Rng rng(11);
  constexpr size_t kCount = 50000;
  Values errors(kCount), deviations(kCount), halves(kCount);
  for (size_t i = 0; i < kCount; ++i) {
    deviations[i] = 0.5 + static_cast<double>(i % 7);
    halves[i] = deviations[i] / 2;
    errors[i] = deviations[i] * rng.normal();
  }
  EXPECT_LT(interval_calibration_error(errors, deviations), 0.005);
  // Half the deviation: the interval of level p holds erf(erfinv(p) / 2); the mean gap over the levels is 0.2151.
  EXPECT_NEAR(interval_calibration_error(errors, halves), 0.2151, 0.005);
}

TEST(IntervalCalibrationError, ByHand) {
  // Quartiles of a Gaussian: |error| = 0.3186 sd (level 0.25) and 1.1503 sd (level 0.75), half of the errors each.
  // Shares at 0.1 ... 0.9: 0 0 .5 .5 .5 .5 .5 1 1; gaps .1 .2 .2 .1 0 .1 .2 .2 .1.
  EXPECT_NEAR(interval_calibration_error(Values{0.3186, -1.1503 * 4}, Values{1, 4}), 1.2 / 9, 1e-12);
  // All inside, and none: the mean of 1 - p, and of p.
  EXPECT_NEAR(interval_calibration_error(Values{0, 1e-12}, Values{1, 0}), 0.5, 1e-12);
  EXPECT_NEAR(interval_calibration_error(Values{1, -1}, Values{0, 1e-3}), 0.5, 1e-12);
}

TEST(RankCorrelation, ByHandWithTies) {
  EXPECT_THAT(rank_correlation(Values{1, 2, 30}, Values{-5, 0, 0.1}), Optional(testing::DoubleEq(1)));
  EXPECT_THAT(rank_correlation(Values{1, 2, 30}, Values{3, 2, 1}), Optional(testing::DoubleEq(-1)));
  // Ranks 1 2.5 2.5 4 and 2 1 3 4; deviations -1.5 0 0 1.5 and -.5 -1.5 .5 1.5: 3 / sqrt(4.5 x 5).
  EXPECT_NEAR(rank_correlation(Values{10, 20, 20, 50}, Values{7, 3, 8, 9}).value(), 3 / std::sqrt(22.5), 1e-12);
}

TEST(RankCorrelation, OfAConstantIsUnknown) {
  EXPECT_THAT(rank_correlation(Values{1, 1, 1}, Values{1, 2, 3}), Eq(std::nullopt));
  EXPECT_THAT(rank_correlation(Values{1}, Values{2}), Eq(std::nullopt));
}

TEST(RocArea, ByHand) {
  EXPECT_THAT(roc_area(Values{1, 2, 3, 4}, {false, false, true, true}), Optional(1.0));
  EXPECT_THAT(roc_area(Values{1, 2, 3, 4}, {true, true, false, false}), Optional(0.0));
  // Events 2 and 3 against 1, 2 and 4: above 1 twice, equal to 2 once and above it once, below 4 twice: 3.5 of 6.
  EXPECT_NEAR(roc_area(Values{2, 3, 1, 2, 4}, {true, true, false, false, false}).value(), 3.5 / 6, 1e-12);
}

TEST(RocArea, OfAConstantIsAHalf) {
  EXPECT_THAT(roc_area(Values{7, 7, 7, 7, 7}, {true, false, false, true, false}), Optional(0.5));
  EXPECT_THAT(roc_area(Values{1, 2}, {true, true}), Eq(std::nullopt));
  EXPECT_THAT(roc_area(Values{1, 2}, {false, false}), Eq(std::nullopt));
}

TEST(MeanOfSurest, DropsTheLeastSure) {
  const Values errors = {10, 20, 30, 40, 50}, uncertainties = {1, 5, 2, 4, 3};
  EXPECT_DOUBLE_EQ(mean_of_surest(errors, uncertainties, 1), 30);
  EXPECT_DOUBLE_EQ(mean_of_surest(errors, uncertainties, 0.8), 32.5);
  EXPECT_DOUBLE_EQ(mean_of_surest(errors, uncertainties, 0.6), 30);
  EXPECT_DOUBLE_EQ(mean_of_surest(errors, uncertainties, 0.4), 20);
  EXPECT_DOUBLE_EQ(mean_of_surest(errors, uncertainties, 0.01), 10);
}

TEST(MeanOfSurest, DoesNotLookAtTheOrderOfEquals) {
  EXPECT_DOUBLE_EQ(mean_of_surest(Values{1, 2, 9}, Values{3, 3, 3}, 0.4), 4);
  EXPECT_DOUBLE_EQ(mean_of_surest(Values{9, 2, 1}, Values{3, 3, 3}, 0.4), 4);
  EXPECT_DOUBLE_EQ(mean_of_surest(Values{6, 2, 1}, Values{3, 3, 1}, 2 / 3.0), 2.5);
}

TEST(Uncertainty, RefusesWhatDoesNotBelongTogether) {
  EXPECT_THROW((void)interval_calibration_error(Values{1}, Values{1, 2}), std::invalid_argument);
  EXPECT_THROW((void)interval_calibration_error(Values{1}, Values{-1}), std::invalid_argument);
  EXPECT_THROW((void)rank_correlation(Values{}, Values{}), std::invalid_argument);
  EXPECT_THROW((void)rank_correlation(Values{std::nan(""), 1}, Values{1, 2}), std::invalid_argument);
  EXPECT_THROW((void)roc_area(Values{1, 2}, {true}), std::invalid_argument);
  EXPECT_THROW((void)mean_of_surest(Values{1}, Values{1}, 0), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
