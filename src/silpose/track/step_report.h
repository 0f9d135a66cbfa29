// StepReport: what one step of a tracker did, and how far to trust it.
// Threads: a value.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <tuple>
#include <vector>

#include "silpose/image/mask.h"
#include "silpose/image/observation.h"

namespace silpose {

// Seconds that the parts of a step took, summed over layers; `start` is the search for a starting pose.
struct StepSeconds {
  double start = 0, propagate = 0, likelihood = 0, resample = 0;
  static auto members(auto& s) { return std::tie(s.start, s.propagate, s.likelihood, s.resample); }
};

// What one step did.
struct StepReport {
  int64_t frame_idx = 0;
  int64_t time_ns = 0;
  enum class State { kWaiting, kInitialised, kTracked, kCoasted } state = State::kWaiting;
  std::vector<double> pose;                                 // [D] the estimate (empty while waiting)
  std::vector<double> mode;                                 // [D] the best particle
  std::vector<double> spread;                               // [D] weighted standard deviation
  std::vector<Eigen::Vector3d> landmark_spread;             // [J + E] metres, as body's landmark_positions
  std::vector<Eigen::Vector3d> landmark_spread_about_root;  // [J + E] of their places relative to the root joint
  double effective_sample_size = 0;
  double visual_accuracy = 0;  // intersection over union in the first camera's image; 0 when coasted
  // Ambiguities: the probability that the network exchanged left and right (of the camera where it is highest), and the
  // weight of hypotheses that face the other way, or have the legs exchanged.
  double exchanged = 0, turned = 0, crossed = 0;
  std::vector<Trust> trust;    // [C]
  std::vector<Mask> observed;  // [C] the masks that were used
  StepSeconds seconds;
  [[nodiscard]] double time_s() const { return static_cast<double>(time_ns) * 1e-9; }

  // For to_bytes(): all but the masks.
  static auto members(auto& r) {
    return std::tie(r.frame_idx, r.time_ns, r.state, r.pose, r.mode, r.spread, r.landmark_spread,
                    r.landmark_spread_about_root, r.effective_sample_size, r.visual_accuracy, r.exchanged, r.turned,
                    r.crossed, r.trust, r.seconds);
  }
};

}  // namespace silpose
