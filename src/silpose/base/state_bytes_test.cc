#include "silpose/base/state_bytes.h"

#include <gtest/gtest.h>

#include <array>
#include <deque>
#include <limits>
#include <memory>
#include <vector>

#include "silpose/base/rng.h"

namespace silpose {
namespace {

enum class Colour { kRed, kGreen };

struct Limb {
  std::string name;
  std::vector<double> angles;
  bool operator==(const Limb&) const = default;
  static auto members(auto& l) { return std::tie(l.name, l.angles); }
};

struct State {
  int step = 0;
  Colour colour = Colour::kRed;
  std::array<double, 2> pair{};
  std::deque<int64_t> areas;
  std::optional<Limb> best, none;
  std::vector<Limb> limbs;
  std::vector<std::pair<std::string, std::string>> lines;
  bool operator==(const State&) const = default;
  static auto members(auto& s) { return std::tie(s.step, s.colour, s.pair, s.areas, s.best, s.none, s.limbs, s.lines); }
};

State some_state() {
  return {.step = -7,
          .colour = Colour::kGreen,
          .pair = {0.1, -std::numeric_limits<double>::infinity()},
          .areas = {1, 2, 3},
          .best = Limb{"arm", {0.1, 0.2}},
          .none = {},
          .limbs = {{"leg", {}}, {"", {1e-300}}},
          .lines = {{"seed", "1"}}};
}

TEST(StateBytes, ComeBackAsTheyWere) {
  State read;
  read.none = Limb{"left over", {}};
  read.areas = {9};
  uint8_t last = 0;
  ASSERT_TRUE(from_bytes(to_bytes(some_state(), uint8_t{5}), read, last));
  EXPECT_EQ(read, some_state());
  EXPECT_EQ(last, 5);
}

TEST(StateBytes, TooFewOrTooManyAreRefused) {
  const std::string bytes = to_bytes(some_state());
  State read;
  for (size_t size = 0; size < bytes.size(); ++size) EXPECT_FALSE(from_bytes(bytes.substr(0, size), read)) << size;
  EXPECT_FALSE(from_bytes(bytes + "x", read));
}

TEST(StateBytes, ABoolIsOneOfTwo) {
  bool value = false;
  EXPECT_TRUE(from_bytes(std::string(1, '\1'), value));
  EXPECT_TRUE(value);
  EXPECT_FALSE(from_bytes(std::string(1, '\2'), value));
}

TEST(StateBytes, WhateverTheCountsSayNoMemoryIsTakenForThem) {
  const std::string good = to_bytes(some_state());
  Rng rng(3);
  for (int trial = 0; trial < 2000; ++trial) {
    std::string bytes = good;
    for (int k = 0; k < 3; ++k) {
      bytes[rng.index(bytes.size())] = static_cast<char>(rng.uniform() < 0.5 ? 0xff : rng.index(256));
    }
    const auto read = std::make_unique<State>();  // GCC 12 is wrong about one on the stack: maybe uninitialised
    (void)from_bytes(bytes, *read);               // must not crash nor take all memory
  }
}

}  // namespace
}  // namespace silpose
