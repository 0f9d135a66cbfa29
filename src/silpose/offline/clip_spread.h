// What the passes over a clip disagree about: hypotheses that fit about as well as the smoothed pose of their instant
// and lie elsewhere widen its spread.
// Threads: functions without state.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

#include "silpose/fit/pose_spread.h"

namespace silpose {

// Weights [K] of hypotheses of `energies` [K], -2 log-likelihood, beside a smoothed pose of energy `smoothed`: the
// hypotheses of each of `num_passes` count as one more pose with it. All weights, with that of the smoothed pose, sum
// to 1.
std::vector<double> weights_beside(double smoothed, std::span<const double> energies, size_t num_passes);

// Adds the scatter of weighted poses [K] of [D] about the smoothed one [D].
void add_disagreement(const BodyModel& body, std::span<const double> smoothed, std::span<const Eigen::VectorXd> poses,
                      std::span<const double> weights, PoseVariances& sum);

}  // namespace silpose
