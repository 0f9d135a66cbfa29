#include "silpose/offline/clip_path.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "silpose/body/test_body.h"
#include "silpose/geometry/rigid3.h"

namespace silpose {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

using Costs = std::vector<std::vector<double>>;
using Transitions = std::vector<std::vector<std::vector<double>>>;  // [T - 1][K][K of the next]

// All paths, one after the other, so that of equally cheap ones that with the lowest last index is met first, and so on
// towards the first instant.
std::vector<size_t> cheapest_of_all(const Costs& costs, const Transitions& transitions) {
  std::vector<size_t> path(costs.size(), 0), best;
  double least = std::numeric_limits<double>::infinity();
  for (bool more = true; more;) {
    double cost = 0;
    for (size_t t = 0; t < path.size(); ++t) {
      cost += costs[t][path[t]];
      if (t > 0) cost += transitions[t - 1][path[t - 1]][path[t]];
    }
    if (cost < least) least = cost, best = path;
    more = false;
    for (size_t t = 0; t < path.size() && !more; ++t) {
      if (++path[t] < costs[t].size()) {
        more = true;
      } else {
        path[t] = 0;
      }
    }
  }
  return best;
}

// Small whole numbers: sums are exact, and many paths cost the same.
TEST(CheapestPath, IsTheCheapestOfAllPaths) {
  std::mt19937 engine(1);
  for (int trial = 0; trial < 300; ++trial) {
    const int most = trial % 3 == 0 ? 1 : trial % 3 == 1 ? 3 : 50;
    const auto number = [&] { return static_cast<double>(engine() % static_cast<unsigned>(most + 1)); };
    const size_t num_instants = 1 + engine() % 5;
    Costs costs(num_instants);
    Transitions transitions(num_instants - 1);
    for (auto& of_instant : costs) {
      of_instant.resize(1 + engine() % 4);
      for (double& cost : of_instant) cost = number();
    }
    for (size_t t = 0; t + 1 < num_instants; ++t) {
      transitions[t].assign(costs[t].size(), std::vector<double>(costs[t + 1].size()));
      for (auto& row : transitions[t]) {
        for (double& cost : row) cost = number();
      }
    }
    const auto transition = [&](size_t t, size_t from, size_t to) { return transitions[t][from][to]; };
    EXPECT_EQ(cheapest_path(costs, transition), cheapest_of_all(costs, transitions)) << "trial " << trial;
  }
}

TEST(CheapestPath, ACostlyCandidateIsTakenWhereItsNeighboursAskForIt) {
  const Costs costs = {{0, 5}, {0, 3}, {9, 0}};
  const auto stay = [](size_t, size_t from, size_t to) { return from == to ? 0.0 : 4.0; };
  // 0 0 1: 0 + 0 + 0 + one change = 4.  1 1 1: 8.  0 1 1: 7.  0 0 0: 9.
  EXPECT_THAT(cheapest_path(costs, stay), ElementsAre(0, 0, 1));
  const auto hold = [](size_t, size_t from, size_t to) { return from == to ? 0.0 : 100.0; };
  EXPECT_THAT(cheapest_path(costs, hold), ElementsAre(1, 1, 1));
}

TEST(CheapestPath, NeedsACandidateAtEachInstant) {
  const auto none = [](size_t, size_t, size_t) { return 0.0; };
  EXPECT_THAT(cheapest_path({}, none), IsEmpty());
  EXPECT_THROW(cheapest_path(Costs{{1}, {}, {1}}, none), std::invalid_argument);
}

class MotionCostTest : public testing::Test {
 protected:
  static Hypotheses one(const Eigen::VectorXd& pose, const Eigen::VectorXd& velocity) { return {{pose}, {velocity}}; }
  static Eigen::VectorXd unit(Eigen::Index dof, double value) {
    Eigen::VectorXd x = Eigen::VectorXd::Zero(8);
    x[dof] = value;
    return x;
  }
  double cost(const Hypotheses& before, const Hypotheses& after, double dt_s) const {
    return motion_cost(skeleton_, deviation_, before, 0, after, 0, dt_s);
  }

  const Skeleton skeleton_ = make_test_body().skeleton;
  const std::vector<double> acceleration_ = make_test_body().profile.acceleration;
  const std::vector<double> deviation_ = std::vector<double>(8, 0.5);
  const Eigen::VectorXd zero_ = Eigen::VectorXd::Zero(8);
};

TEST_F(MotionCostTest, WhatMovesAtTheMeanVelocityCostsNothing) {
  // 1 m/s and 3 m/s for 0.25 s: half a metre.
  EXPECT_NEAR(cost(one(zero_, unit(0, 1)), one(unit(0, 0.5), unit(0, 3)), 0.25), 0, 1e-12);
}

TEST_F(MotionCostTest, SquaredOffsetsInUnitsOfTheDeviation) {
  EXPECT_NEAR(cost(one(zero_, zero_), one(unit(0, 1), zero_), 0.1), 4, 1e-12);
  EXPECT_NEAR(cost(one(unit(4, 0.25), zero_), one(unit(0, 1), zero_), 0.1), 4.25, 1e-12);
  EXPECT_NEAR(cost(one(zero_, zero_), one(unit(0, 100), zero_), 0.1), kMostMotionCost, 1e-12);  // limited
}

TEST_F(MotionCostTest, PeriodicAnglesGoTheShortWayRound) {
  const double ratio = to_radians(20) / 0.5;
  EXPECT_NEAR(cost(one(unit(3, to_radians(170)), zero_), one(unit(3, to_radians(-170)), zero_), 0.1), ratio * ratio,
              1e-12);
}

// A still body, and at each instant a second hypothesis 0.3 m to the right that fits better at one instant only. A path
// that jumps there and back would fit best, but would not move plausibly.
TEST_F(MotionCostTest, BestPathDoesNotJump) {
  std::vector<Hypotheses> hypotheses;
  std::vector<std::vector<double>> energies(5, {1, 100});
  energies[2] = {3, 1};
  std::vector<int64_t> times_ns;
  for (int t = 0; t < 5; ++t) {
    hypotheses.push_back({{zero_, unit(0, 0.3)}, {zero_, zero_}});
    times_ns.push_back(t * int64_t{33'333'333});
  }
  for (const Eigen::VectorXd& pose : best_path(skeleton_, acceleration_, hypotheses, energies, times_ns))
    EXPECT_EQ(pose, zero_);
  energies[2] = {300, 1};  // more than two jumps cost
  const std::vector<Eigen::VectorXd> jumped = best_path(skeleton_, acceleration_, hypotheses, energies, times_ns);
  EXPECT_EQ(jumped[1], zero_);
  EXPECT_EQ(jumped[2], unit(0, 0.3));
  EXPECT_EQ(jumped[3], zero_);
}

// Two instants of nothing seen, in which both hypotheses cost the same: the one that leads on at its velocity is taken,
// over the time that has passed.
TEST_F(MotionCostTest, BestPathBridgesAGapByVelocity) {
  constexpr double kSpeed = 1.5;
  const std::vector<int64_t> times_ns = {0, 100'000'000, 350'000'000, 400'000'000};
  std::vector<Hypotheses> hypotheses;
  std::vector<std::vector<double>> energies = {{0}, {0, 0}, {0, 0}, {0}};
  for (size_t t = 0; t < times_ns.size(); ++t) {
    const Eigen::VectorXd moving = unit(0, kSpeed * static_cast<double>(times_ns[t]) * 1e-9),
                          velocity = unit(0, kSpeed);
    hypotheses.push_back({{moving}, {velocity}});
    if (t == 1 || t == 2) hypotheses.back() = {{zero_, moving}, {velocity, velocity}};
  }
  const std::vector<Eigen::VectorXd> path = best_path(skeleton_, acceleration_, hypotheses, energies, times_ns);
  EXPECT_EQ(path[1], hypotheses[1].poses[1]);
  EXPECT_EQ(path[2], hypotheses[2].poses[1]);
  EXPECT_THROW(best_path(skeleton_, acceleration_, hypotheses, energies, {}), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
