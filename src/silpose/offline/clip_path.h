// The best path through a clip: of the hypotheses at each instant one, so that together they fit the observations best
// and move most plausibly.
// Source: Viterbi's algorithm (references.bib: viterbi1967).
// Threads: functions without state.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "silpose/body/skeleton.h"
#include "silpose/offline/clip_hypotheses.h"

namespace silpose {

// The cost of following candidate `from` of instant t by candidate `to` of instant t + 1.
using TransitionCost = std::function<double(size_t t, size_t from, size_t to)>;

// The candidates [T] whose costs and transitions sum to the least. `costs` [T][K] of the candidates of each instant, of
// which there may be different numbers. Of paths that cost the same, the one with the lowest index at the last instant,
// then at the one before, and so on.
// Errors: throws std::invalid_argument for an instant without a candidate.
std::vector<size_t> cheapest_path(std::span<const std::vector<double>> costs, const TransitionCost& transition);

// How implausibly hypothesis `to` follows hypothesis `from` after `dt_s`: squared offsets from where the mean of both
// velocities leads, in units of `deviation` [D], each limited and summed over DOFs.
double motion_cost(const Skeleton& skeleton, std::span<const double> deviation, const Hypotheses& before, size_t from,
                   const Hypotheses& after, size_t to, double dt_s);

// [guess] Limit of one DOF's part of motion_cost().
inline constexpr double kMostMotionCost = 30;

// The poses [T] of [D] of the best path. `acceleration` [D]: deviations, as in body/rig_profile.h. `energies` [T][K] of
// the hypotheses, -2 log-likelihood; times must grow.
// Errors: as cheapest_path().
std::vector<Eigen::VectorXd> best_path(const Skeleton& skeleton, std::span<const double> acceleration,
                                       std::span<const Hypotheses> hypotheses,
                                       std::span<const std::vector<double>> energies,
                                       std::span<const int64_t> times_ns);

}  // namespace silpose
