#include "silpose/filter/resampling.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace silpose {
namespace {

std::vector<double> logs(const std::vector<double>& weight) {
  std::vector<double> result;
  for (const double w : weight) result.push_back(std::log(w));
  return result;
}

std::vector<int> counts_of(const std::vector<int>& ancestors, size_t num_particles) {
  std::vector<int> counts(num_particles, 0);
  for (const int a : ancestors) {
    if (a != kRegenerate) ++counts[static_cast<size_t>(a)];
  }
  return counts;
}

// The contract on top of resampling.h, for every scheme.
struct Scheme {
  const char* name;
  double regenerate_fraction;
};

class ResamplerContract : public testing::TestWithParam<Scheme> {
 protected:
  std::unique_ptr<Resampler> resampler_ = make_resampler(GetParam().name, GetParam().regenerate_fraction).value();
};

TEST_P(ResamplerContract, GivesAsManyValidAncestorsAsAsked) {
  const std::vector<double> log_weight = logs({0.1, 0.2, 0.3, 0.4});
  for (const int num_samples : {1, 3, 4, 1000}) {
    Rng rng(7);
    const std::vector<int> ancestors = resampler_->resample(log_weight, num_samples, rng);
    ASSERT_EQ(ancestors.size(), static_cast<size_t>(num_samples));
    for (const int a : ancestors) EXPECT_TRUE(a == kRegenerate || (a >= 0 && a < 4)) << a;
    EXPECT_GT(std::count_if(ancestors.begin(), ancestors.end(), [](int a) { return a >= 0; }), 0);
  }
}

TEST_P(ResamplerContract, NeverTakesAParticleWithoutWeight) {
  const std::vector<double> log_weight = logs({0, 0.5, 0, 0.5, 0});
  for (uint64_t seed = 0; seed < 200; ++seed) {
    Rng rng(seed);
    const std::vector<int> counts = counts_of(resampler_->resample(log_weight, 17, rng), 5);
    EXPECT_EQ(counts[0] + counts[2] + counts[4], 0);
  }
}

TEST_P(ResamplerContract, TakesTheOnlyParticleWithWeight) {
  Rng rng(3);
  for (const int a : resampler_->resample(logs({0, 0, 1, 0}), 9, rng)) EXPECT_TRUE(a == 2 || a == kRegenerate);
}

TEST_P(ResamplerContract, AllImpossibleCountsAsUniform) {
  Rng rng(3);
  const std::vector<double> log_weight(10, -std::numeric_limits<double>::infinity());
  const std::vector<int> counts = counts_of(resampler_->resample(log_weight, 1000, rng), 10);
  EXPECT_GE(*std::max_element(counts.begin(), counts.end()), 99);
  EXPECT_LE(*std::max_element(counts.begin(), counts.end()), 101);
}

TEST_P(ResamplerContract, DoesNotMindTheScaleOfLogWeights) {
  Rng a(5), b(5);
  EXPECT_EQ(resampler_->resample(std::vector{-3.0, -1.0, -2.0}, 50, a),
            resampler_->resample(std::vector{-10003.0, -10001.0, -10002.0}, 50, b));
}

TEST_P(ResamplerContract, RefusesBadInput) {
  Rng rng(1);
  EXPECT_THROW((void)resampler_->resample({}, 3, rng), std::invalid_argument);
  EXPECT_THROW((void)resampler_->resample(std::vector{0.0}, 0, rng), std::invalid_argument);
  EXPECT_THROW((void)resampler_->resample(std::vector{0.0, std::nan("")}, 3, rng), std::invalid_argument);
}

INSTANTIATE_TEST_SUITE_P(All, ResamplerContract,
                         testing::Values(Scheme{"systematic", 0.2}, Scheme{"comb", 0.0}, Scheme{"comb", 0.2},
                                         Scheme{"comb", 0.5}),
                         [](const auto& param) {
                           return std::string(param.param.name) +
                                  std::to_string(static_cast<int>(100 * param.param.regenerate_fraction));
                         });

class UnbiasedResampler : public testing::TestWithParam<const char*> {};

TEST_P(UnbiasedResampler, KeepsExpectedCounts) {
  const auto resampler = make_resampler(GetParam(), 0).value();
  const std::vector<double> weight = {0.03, 0.17, 0.05, 0.31, 0.44};
  constexpr int kSamples = 7, kRuns = 4000;
  std::vector<double> total(weight.size(), 0);
  for (uint64_t seed = 0; seed < kRuns; ++seed) {
    Rng rng(seed);
    const std::vector<int> counts = counts_of(resampler->resample(logs(weight), kSamples, rng), weight.size());
    for (size_t i = 0; i < weight.size(); ++i) {
      EXPECT_LT(std::abs(counts[i] - kSamples * weight[i]), 1);
      total[i] += counts[i];
    }
  }
  for (size_t i = 0; i < weight.size(); ++i) EXPECT_NEAR(total[i] / kRuns, kSamples * weight[i], 0.03);
}

INSTANTIATE_TEST_SUITE_P(All, UnbiasedResampler, testing::Values("systematic", "comb"));

// Thesis Fig. 2.26: 14 particles, half of them regenerated, 7 teeth over the heavier half.
TEST(CombResampling, RegeneratesTheLowestWeightedHalf) {
  const auto comb = make_resampler("comb", 0.5).value();
  const std::vector<double> weight = {14, 1, 13, 2, 12, 3, 11, 4, 10, 5, 9, 6, 8, 7};
  for (uint64_t seed = 0; seed < 100; ++seed) {
    Rng rng(seed);
    const std::vector<int> ancestors = comb->resample(logs(weight), 14, rng);
    EXPECT_EQ(std::count(ancestors.begin(), ancestors.end(), kRegenerate), 7);
    for (const int a : ancestors) {
      if (a == kRegenerate) continue;
      EXPECT_GE(weight[static_cast<size_t>(a)], 8);
    }
    // Teeth are 77 / 7 = 11 apart: a particle that weighs at least that much is hit.
    for (const int heavy : {0, 2, 4, 6}) EXPECT_TRUE(std::count(ancestors.begin(), ancestors.end(), heavy) >= 1);
  }
}

TEST(MakeResampler, NamesWhatItDoesNotKnow) {
  const auto unknown = make_resampler("roulette");
  ASSERT_FALSE(unknown.ok());
  EXPECT_NE(unknown.error().message.find("roulette"), std::string::npos);
  EXPECT_NE(unknown.error().message.find("comb, systematic"), std::string::npos);
  EXPECT_FALSE(make_resampler("multinomial").ok());
  EXPECT_FALSE(make_resampler("comb", 1.0).ok());
  EXPECT_FALSE(make_resampler("comb", -0.1).ok());
  EXPECT_FALSE(make_resampler("comb", std::nan("")).ok());
}

}  // namespace
}  // namespace silpose
