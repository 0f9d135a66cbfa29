#include "silpose/track/keypoint_sides.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "silpose/base/check.h"

namespace silpose {
namespace {

using States = std::array<double, 2>;  // probability or likelihood of: sides as they are, sides exchanged

// [guess] How often a network begins to exchange the sides and ends, per second, and how likely it does at first.
constexpr double kBegins_per_s = 0.3, kEnds_per_s = 0.6, kAtFirst = 0.03;
// [guess] How far the line across the body turns: by the network's own noise, and by a quick pivot.
constexpr double kNoise_rad = 0.3, kTurn_rad_per_s = 3;
constexpr double kOutlier = 0.05;      // of the likelihood: what tells nothing
constexpr double kLongestGap_s = 0.5;  // after which the body may face anywhere

// transition[i][j]: from state i to state j in `dt_s`, and that the line turned so.
struct Transition {
  States from_as_is, from_exchanged;
};

Transition transition(const Eigen::Vector3d& before, const Eigen::Vector3d& now, double dt_s) {
  const double turned = std::atan2(before.cross(now).norm(), before.dot(now));
  const double deviation = std::hypot(kNoise_rad, kTurn_rad_per_s * dt_s);
  const auto likelihood = [&](double off) { return kOutlier + std::exp(-0.5 * std::pow(off / deviation, 2)); };
  const double same = likelihood(turned), other = likelihood(std::numbers::pi - turned);
  const double begins = 1 - std::exp(-kBegins_per_s * dt_s), ends = 1 - std::exp(-kEnds_per_s * dt_s);
  return {{(1 - begins) * same, begins * other}, {ends * other, (1 - ends) * same}};
}

void normalise(States& states) {
  const double sum = states[0] + states[1];
  for (double& state : states) state /= sum;
}

}  // namespace

std::optional<Eigen::Vector3d> line_across(const Keypoints3D& keypoints) {
  Eigen::Vector3d line = Eigen::Vector3d::Zero();
  for (const auto& [right, left] : {std::pair{"right_thigh", "left_thigh"}, {"right_upper_arm", "left_upper_arm"}}) {
    const Keypoint3D *a = keypoints.find(right), *b = keypoints.find(left);
    if (!a || !b) return std::nullopt;
    for (int i = 0; i < 3; ++i) line[i] += b->x[static_cast<size_t>(i)] - a->x[static_cast<size_t>(i)];
  }
  if (!(line.norm() > 0)) return std::nullopt;
  return line.normalized();
}

double KeypointSides::step(const Keypoints3D& keypoints, double dt_s) {
  since_last_s_ += dt_s;
  const std::optional<Eigen::Vector3d> now = line_across(keypoints);
  if (!now) return 0;
  if (!last_ || since_last_s_ > kLongestGap_s) {
    exchanged_ = kAtFirst;
  } else {
    const Transition by = transition(*last_, *now, since_last_s_);
    States states;
    for (size_t j = 0; j < 2; ++j) states[j] = (1 - exchanged_) * by.from_as_is[j] + exchanged_ * by.from_exchanged[j];
    normalise(states);
    exchanged_ = states[1];
  }
  last_ = now;
  since_last_s_ = 0;
  return exchanged_;
}

std::vector<double> exchanged_sides(std::span<const Keypoints3D* const> keypoints, std::span<const int64_t> times_ns) {
  check(keypoints.size() == times_ns.size(), "exchanged_sides: {} frames, {} times", keypoints.size(), times_ns.size());
  std::vector<double> exchanged(keypoints.size(), 0.0);
  // Runs of frames without a long gap, each by itself.
  std::vector<size_t> frames;
  std::vector<Eigen::Vector3d> lines;
  const auto finish = [&] {
    const size_t count = frames.size();
    if (count == 0) return;
    std::vector<Transition> by(count);
    std::vector<States> forward(count), backward(count, {1, 1});
    forward[0] = {1 - kAtFirst, kAtFirst};
    for (size_t i = 1; i < count; ++i) {
      by[i] =
          transition(lines[i - 1], lines[i], static_cast<double>(times_ns[frames[i]] - times_ns[frames[i - 1]]) * 1e-9);
      for (size_t j = 0; j < 2; ++j) {
        forward[i][j] = forward[i - 1][0] * by[i].from_as_is[j] + forward[i - 1][1] * by[i].from_exchanged[j];
      }
      normalise(forward[i]);
    }
    for (size_t i = count - 1; i-- > 0;) {
      const Transition& next = by[i + 1];
      backward[i] = {next.from_as_is[0] * backward[i + 1][0] + next.from_as_is[1] * backward[i + 1][1],
                     next.from_exchanged[0] * backward[i + 1][0] + next.from_exchanged[1] * backward[i + 1][1]};
      normalise(backward[i]);
    }
    for (size_t i = 0; i < count; ++i) {
      States states{forward[i][0] * backward[i][0], forward[i][1] * backward[i][1]};
      normalise(states);
      exchanged[frames[i]] = states[1];
    }
    frames.clear();
    lines.clear();
  };
  for (size_t t = 0; t < keypoints.size(); ++t) {
    const std::optional<Eigen::Vector3d> line = line_across(*keypoints[t]);
    if (!line) continue;
    if (!frames.empty() && static_cast<double>(times_ns[t] - times_ns[frames.back()]) * 1e-9 > kLongestGap_s) finish();
    frames.push_back(t);
    lines.push_back(*line);
  }
  finish();
  return exchanged;
}

}  // namespace silpose
