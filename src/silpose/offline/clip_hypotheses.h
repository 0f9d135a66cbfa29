// Hypotheses: what the passes over a clip found at one instant. A value.
#pragma once

#include <Eigen/Core>
#include <tuple>
#include <vector>

namespace silpose {

// Poses [K] of [D], and their velocities [K] of [D] per second of the clip's time.
struct Hypotheses {
  std::vector<Eigen::VectorXd> poses, velocities;

  static auto members(auto& h) { return std::tie(h.poses, h.velocities); }
};

}  // namespace silpose
