// Random poses of a body, for measurements that want all kinds of them.
// Threads: pure but for the stream.
#pragma once

#include <span>
#include <vector>

#include "silpose/base/rng.h"
#include "silpose/body/skeleton.h"

namespace silpose {

struct RandomPoseRange {
  double part = 1;     // of each angle's limits, drawn in towards the base pose; 0: the base pose itself
  double shift_m = 0;  // how far each translation goes, either way
};

// A pose around `base` [D], every angle and translation uniform in its range; properties of the body stay. [D]
[[nodiscard]] std::vector<double> random_pose(const Skeleton& skeleton, std::span<const double> base, Rng& rng,
                                              const RandomPoseRange& range = {});

}  // namespace silpose
