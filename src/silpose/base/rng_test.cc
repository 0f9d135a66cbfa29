#include "silpose/base/rng.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <set>
#include <stdexcept>
#include <vector>

namespace silpose {
namespace {

// xoshiro256++ and SplitMix64 written out a second time, from their
// definitions.
struct Reference {
  uint64_t s[4];

  static uint64_t mix(uint64_t& x) {
    x += 0x9e3779b97f4a7c15u;
    uint64_t z = x;
    z ^= z >> 30;
    z *= 0xbf58476d1ce4e5b9u;
    z ^= z >> 27;
    z *= 0x94d049bb133111ebu;
    z ^= z >> 31;
    return z;
  }
  static uint64_t rotate(uint64_t x, int k) { return x << k | x >> (64 - k); }
  explicit Reference(uint64_t mixed) {
    for (uint64_t& word : s) word = mix(mixed);
  }
  uint64_t next() {
    const uint64_t result = rotate(s[0] + s[3], 23) + s[0];
    const uint64_t t = s[1] << 17;
    s[2] ^= s[0];
    s[3] ^= s[1];
    s[1] ^= s[2];
    s[0] ^= s[3];
    s[2] ^= t;
    s[3] = rotate(s[3], 45);
    return result;
  }
};

TEST(Rng, FollowsItsDefinition) {
  for (const uint64_t seed : {uint64_t{1}, uint64_t{2}, ~uint64_t{0}}) {
    uint64_t mixed = seed;
    mixed = Reference::mix(mixed) ^ 3;
    mixed = Reference::mix(mixed) ^ 17;
    Reference reference(mixed);
    Rng rng(seed, 3, 17);
    for (int i = 0; i < 100; ++i) ASSERT_EQ(rng.bits(), reference.next()) << seed << " " << i;
  }
}

TEST(Rng, GoldenValues) {
  Rng rng(1);
  const std::array<uint64_t, 4> golden = {0x3f8506cb87cd7d91u, 0x7141f0034b964604u, 0x3b07bf3afad2e5u,
                                          0x592d5816cb7de2aau};
  for (const uint64_t value : golden) EXPECT_EQ(rng.bits(), value);
}

TEST(Rng, SameStreamSameNumbers) {
  Rng a(5, 2, 9), b(5, 2, 9);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(a.normal(), b.normal());
}

TEST(Rng, StreamsOfNeighboursAreUnrelated) {
  // Every coordinate matters, and they do not stand in for one another.
  std::set<uint64_t> first;
  for (uint64_t seed = 0; seed < 12; ++seed) {
    for (uint64_t step = 0; step < 12; ++step) {
      for (uint64_t particle = 0; particle < 12; ++particle) first.insert(Rng(seed, step, particle).bits());
    }
  }
  EXPECT_EQ(first.size(), 12u * 12 * 12);

  // First draws over particles: as even as draws within a stream, and not
  // correlated with the next particle's.
  constexpr int kCount = 20000;
  double sum = 0, product = 0, before = Rng(7, 1, 0).uniform() - 0.5;
  for (uint64_t particle = 1; particle <= kCount; ++particle) {
    const double value = Rng(7, 1, particle).uniform() - 0.5;
    sum += value;
    product += value * before;
    before = value;
  }
  EXPECT_LT(std::abs(sum / kCount), 4 * std::sqrt(1.0 / 12 / kCount));
  EXPECT_LT(std::abs(product / kCount), 4.0 / 12 / std::sqrt(kCount));
}

TEST(Rng, UniformIsEvenAndStaysInside) {
  Rng rng(3);
  std::array<int, 20> counts{};
  constexpr int kCount = 100000;
  for (int i = 0; i < kCount; ++i) {
    const double value = rng.uniform();
    ASSERT_GE(value, 0);
    ASSERT_LT(value, 1);
    ++counts[static_cast<size_t>(value * 20)];
  }
  double chi_square = 0;
  for (const int count : counts) chi_square += (count - kCount / 20.0) * (count - kCount / 20.0) / (kCount / 20.0);
  EXPECT_LT(chi_square, 43.8);  // 19 degrees of freedom, 0.1 %
  for (int i = 0; i < 1000; ++i) {
    const double value = rng.uniform(-2, 3);
    ASSERT_TRUE(value >= -2 && value < 3);
  }
}

TEST(Rng, NormalHasItsMoments) {
  Rng rng(11);
  constexpr int kCount = 200000;
  std::array<double, 5> moments{};
  int beyond_two = 0;
  for (int i = 0; i < kCount; ++i) {
    const double value = rng.normal();
    for (int power = 1; power <= 4; ++power) moments[static_cast<size_t>(power)] += std::pow(value, power) / kCount;
    beyond_two += std::abs(value) > 1.959964 ? 1 : 0;
  }
  EXPECT_NEAR(moments[1], 0, 4 * std::sqrt(1.0 / kCount));
  EXPECT_NEAR(moments[2], 1, 4 * std::sqrt(2.0 / kCount));
  EXPECT_NEAR(moments[3], 0, 4 * std::sqrt(15.0 / kCount));
  EXPECT_NEAR(moments[4], 3, 4 * std::sqrt(96.0 / kCount));
  EXPECT_NEAR(beyond_two / static_cast<double>(kCount), 0.05, 4 * std::sqrt(0.05 * 0.95 / kCount));
}

TEST(Rng, PairsOfNormalsAreUnrelated) {
  Rng rng(12);
  constexpr int kCount = 100000;
  double product = 0;
  for (int i = 0; i < kCount; ++i) product += rng.normal() * rng.normal();
  EXPECT_NEAR(product / kCount, 0, 4 / std::sqrt(kCount));
}

TEST(Rng, IndexIsEven) {
  Rng rng(4);
  std::array<int, 7> counts{};
  constexpr int kCount = 70000;
  for (int i = 0; i < kCount; ++i) ++counts.at(rng.index(7));
  for (const int count : counts) EXPECT_NEAR(count, kCount / 7.0, 4 * std::sqrt(kCount / 7.0));
  EXPECT_EQ(rng.index(1), 0u);
  EXPECT_THROW((void)rng.index(0), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
