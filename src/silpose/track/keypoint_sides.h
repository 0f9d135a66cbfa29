// KeypointSides: whether a network exchanged a body's left and right. A network sees each image by itself. From behind,
// or from the side, it may exchange the sides for some frames. It then sees the body mirrored in depth: the line across
// hips and shoulders points the other way in the image, and the same way in depth. A body does not turn by 180 degrees
// within a tenth of a second. So the line is tracked over time, and each frame's line is compared with it and with its
// mirror image. Based on: a hidden Markov model of two states (references.bib: rabiner1989). Threads: values and
// functions without state.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <tuple>
#include <vector>

#include "silpose/image/keypoints3d.h"

namespace silpose {

// From right to left across hips and shoulders, a unit vector in the axes of the keypoints; nothing where they lack
// these.
std::optional<Eigen::Vector3d> line_across(const Keypoints3D& keypoints);

// Frame by frame, as an online tracker sees them.
class KeypointSides {
 public:
  // The probability that the sides are exchanged in the next frame's keypoints, `dt_s` seconds after those before. 0
  // where there are none.
  double step(const Keypoints3D& keypoints, double dt_s);

  static auto members(auto& s) { return std::tie(s.exchanged_, s.line_, s.since_last_s_, s.as_is_s_, s.exchanged_s_); }

 private:
  double exchanged_ = 0;
  std::optional<Eigen::Vector3d> line_;  // across the body, as tracked
  double since_last_s_ = 0;
  double as_is_s_ = 0, exchanged_s_ = 0;  // how long each state held
};

// The same for all frames of a clip at once. The longer part of each stretch without a gap is right. Shapes: keypoints
// and times [T] -> [T].
std::vector<double> exchanged_sides(std::span<const Keypoints3D* const> keypoints, std::span<const int64_t> times_ns);

// Keypoints are not used where an exchange is more probable than this, which is: more probable than not. [definition]
inline constexpr double kExchanged = 0.5;

}  // namespace silpose
