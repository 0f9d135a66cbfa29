#include "silpose/offline/clip_path.h"

#include <algorithm>
#include <limits>

#include "silpose/base/check.h"
#include "silpose/geometry/rigid3.h"

namespace silpose {
namespace {

using Eigen::VectorXd;

// [guess] Times the profile's acceleration: hypotheses are fits and have errors of their own.
constexpr double kMotionDeviation = 4;

}  // namespace

std::vector<size_t> cheapest_path(std::span<const std::vector<double>> costs, const TransitionCost& transition) {
  if (costs.empty()) return {};
  for (size_t t = 0; t < costs.size(); ++t) check(!costs[t].empty(), "cheapest_path: no candidate at instant {}", t);
  // Of each candidate, the cost of the cheapest path that ends there, and the candidate before it on that path.
  std::vector<std::vector<double>> cost(costs.begin(), costs.end());
  std::vector<std::vector<size_t>> before(costs.size());
  for (size_t t = 1; t < costs.size(); ++t) {
    before[t].assign(costs[t].size(), 0);
    for (size_t k = 0; k < costs[t].size(); ++k) {
      double least = std::numeric_limits<double>::infinity();
      for (size_t j = 0; j < cost[t - 1].size(); ++j) {
        const double value = cost[t - 1][j] + transition(t - 1, j, k);
        if (value < least) least = value, before[t][k] = j;
      }
      cost[t][k] += least;
    }
  }
  std::vector<size_t> path(costs.size());
  path.back() = static_cast<size_t>(std::ranges::min_element(cost.back()) - cost.back().begin());
  for (size_t t = costs.size() - 1; t > 0; --t) path[t - 1] = before[t][path[t]];
  return path;
}

double motion_cost(const Skeleton& skeleton, std::span<const double> deviation, const Hypotheses& before, size_t from,
                   const Hypotheses& after, size_t to, double dt_s) {
  const VectorXd velocity = 0.5 * (before.velocities[from] + after.velocities[to]);
  double cost = 0;
  for (Eigen::Index d = 0; d < velocity.size(); ++d) {
    double off = after.poses[to][d] - before.poses[from][d] - dt_s * velocity[d];
    if (skeleton.dofs()[static_cast<size_t>(d)].is_periodic) off = wrap_angle(off);
    const double ratio = off / deviation[static_cast<size_t>(d)];
    cost += std::min(ratio * ratio, kMostMotionCost);
  }
  return cost;
}

std::vector<VectorXd> best_path(const Skeleton& skeleton, std::span<const double> acceleration,
                                std::span<const Hypotheses> hypotheses, std::span<const std::vector<double>> energies,
                                std::span<const int64_t> times_ns) {
  check(energies.size() == hypotheses.size() && times_ns.size() == hypotheses.size(),
        "best_path: {} energies and {} times of {} instants", energies.size(), times_ns.size(), hypotheses.size());
  std::vector<double> deviation(acceleration.begin(), acceleration.end());
  for (double& of_dof : deviation) of_dof *= kMotionDeviation;
  const std::vector<size_t> path = cheapest_path(energies, [&](size_t t, size_t from, size_t to) {
    const double dt_s = static_cast<double>(times_ns[t + 1] - times_ns[t]) * 1e-9;
    return motion_cost(skeleton, deviation, hypotheses[t], from, hypotheses[t + 1], to, dt_s);
  });
  std::vector<VectorXd> poses;
  for (size_t t = 0; t < path.size(); ++t) poses.push_back(hypotheses[t].poses[path[t]]);
  return poses;
}

}  // namespace silpose
