// The one pose that represents a weighted particle set.
// Threads: functions without state.
#pragma once

#include <span>
#include <vector>

#include "silpose/body/body_model.h"
#include "silpose/filter/particle_set.h"
#include "silpose/track/tracker_options.h"

namespace silpose {

// DOF that wrap.
std::vector<int> periodic_dofs(const Skeleton& skeleton);

// [D] The weighted mean, the best particle, or the mean of the cluster about it, inside the limits. `scale` [>= D] is
// what counts as far in each DOF, for the cluster. REQUIRES: particles whose first D columns are poses.
std::vector<double> pose_estimate(const Skeleton& skeleton, const ParticleSet& particles, Estimate kind,
                                  std::span<const double> scale);

}  // namespace silpose
