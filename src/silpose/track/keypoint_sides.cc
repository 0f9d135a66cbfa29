#include "silpose/track/keypoint_sides.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

#include "silpose/base/check.h"
#include "silpose/shape/keypoint_axes.h"

namespace silpose {
namespace {

// [guess] Rates at which exchanges begin and end, and the probability of one in the first frame.
constexpr double kBegins_per_s = 1, kEnds_per_s = 2, kAtFirst = 0.03;
// [guess] Standard deviation of a line by the network's noise. Exchanged lines that were looked at were up to 0.5 rad
// off the mirror image.
constexpr double kNoise_rad = 0.45;
constexpr double kFastest_rad_per_s = 5;     // [guess] how fast a body pivots: the tracked line turns no faster
constexpr double kIndependent_s = 1.0 / 30;  // [guess] closer frames have correlated noise, and count in proportion
constexpr double kOutlier = 0.01;            // [guess] likelihood of an outlier, for either state
constexpr double kLongestGap_s = 0.5;        // [guess] after a longer gap the body may face in any direction
// [guess] The state in which a sequence began is revised after it was the other one for this long at least, and for as
// long as it was the first; durations are counted up to kMemory_s.
constexpr double kLeastExchanged_s = 1, kMemory_s = 3;

Eigen::Vector3d mirrored(const Eigen::Vector3d& line) { return {-line.x(), -line.y(), line.z()}; }

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

double likelihood(const Eigen::Vector3d& line, const Eigen::Vector3d& expected) {
  const double off = angle_between(line, expected) / kNoise_rad;
  return kOutlier + std::exp(-0.5 * off * off);
}

}  // namespace

std::optional<Eigen::Vector3d> line_across(const Keypoints3D& keypoints) {
  Eigen::Vector3d line = Eigen::Vector3d::Zero();
  for (const auto& [right, left] : {kHipKeypoints, kShoulderKeypoints}) {
    const Keypoint3D *a = keypoints.find(right), *b = keypoints.find(left);
    if (!a || !b) return std::nullopt;
    for (int i = 0; i < 3; ++i) line[i] += b->x[static_cast<size_t>(i)] - a->x[static_cast<size_t>(i)];
  }
  if (!line.allFinite() || !(line.norm() > 0)) return std::nullopt;
  return line.normalized();
}

double KeypointSides::step(const Keypoints3D& keypoints, double dt_s) {
  since_last_s_ += dt_s;
  const std::optional<Eigen::Vector3d> now = line_across(keypoints);
  if (!now) return 0;
  const double passed_s = std::exchange(since_last_s_, 0.0);
  if (!line_ || passed_s > kLongestGap_s) {
    line_ = now;
    exchanged_ = kAtFirst;
    as_is_s_ = exchanged_s_ = 0;
    return exchanged_;
  }
  const double begins = 1 - std::exp(-kBegins_per_s * passed_s), ends = 1 - std::exp(-kEnds_per_s * passed_s);
  const double before = exchanged_ * (1 - ends) + (1 - exchanged_) * begins;
  const double worth = std::min(1.0, passed_s / kIndependent_s);
  const double if_as_is = (1 - before) * std::pow(likelihood(*now, *line_), worth),
               if_exchanged = before * std::pow(likelihood(*now, mirrored(*line_)), worth);
  exchanged_ = if_exchanged / (if_as_is + if_exchanged);
  const Eigen::Vector3d true_line = (1 - exchanged_) * *now + exchanged_ * mirrored(*now);
  const double off = angle_between(*line_, true_line);
  const double share = std::min(1.0, kFastest_rad_per_s * passed_s / std::max(off, 1e-9));
  *line_ = ((1 - share) * *line_ + share * true_line.stableNormalized()).stableNormalized();
  double& held_s = exchanged_ > kExchanged ? exchanged_s_ : as_is_s_;
  held_s = std::min(held_s + passed_s, kMemory_s);
  if (exchanged_s_ >= std::clamp(as_is_s_, kLeastExchanged_s, kMemory_s)) {  // the sequence began exchanged
    *line_ = mirrored(*line_);
    exchanged_ = 1 - exchanged_;
    std::swap(as_is_s_, exchanged_s_);
  }
  return exchanged_;
}

std::vector<double> exchanged_sides(std::span<const Keypoints3D* const> keypoints, std::span<const int64_t> times_ns) {
  check(keypoints.size() == times_ns.size(), "exchanged_sides: {} frames, {} times", keypoints.size(), times_ns.size());
  std::vector<double> exchanged(keypoints.size(), 0.0);
  size_t first = 0, last_seen = 0;
  // A second, backward pass over the stretch compares its first frames with later ones.
  const auto judge = [&](size_t begin, size_t end) {
    KeypointSides sides;
    for (const bool again : {false, true}) {
      for (size_t i = begin; i < end; ++i) {
        const size_t t = again ? end - 1 - (i - begin) : i, before = again ? t + 1 : t - 1;
        const bool is_first = i == begin;
        const double dt_s = is_first ? 0 : std::abs(static_cast<double>(times_ns[t] - times_ns[before])) * 1e-9;
        exchanged[t] = sides.step(*keypoints[t], dt_s);
      }
    }
  };
  bool any = false;
  for (size_t t = 0; t < keypoints.size(); ++t) {
    if (!line_across(*keypoints[t])) continue;
    if (any && static_cast<double>(times_ns[t] - times_ns[last_seen]) * 1e-9 > kLongestGap_s) {
      judge(first, last_seen + 1);
      first = t;
    }
    any = true;
    last_seen = t;
  }
  if (any) judge(first, last_seen + 1);
  return exchanged;
}

}  // namespace silpose
