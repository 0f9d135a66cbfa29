#include "silpose/track/keypoint_sides.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "silpose/base/rng.h"
#include "silpose/geometry/rigid3.h"

namespace silpose {
namespace {

constexpr int64_t kFrame_ns = 33'000'000;

// Hips and shoulders of a body whose left lies at `heading` about the vertical; a network that exchanges the sides
// mirrors it.
Keypoints3D facing(double heading, bool exchanged = false) {
  const double c = (exchanged ? -1 : 1) * std::cos(heading), s = (exchanged ? -1 : 1) * std::sin(heading);
  Keypoints3D keypoints{100, 100, {}};
  for (const auto& [part, half, height] : {std::tuple{"thigh", 0.1, 0.0}, {"upper_arm", 0.18, -0.5}}) {
    keypoints.points.push_back({std::string("left_") + part, {half * c, height, half * s}});
    keypoints.points.push_back({std::string("right_") + part, {-half * c, height, -half * s}});
  }
  return keypoints;
}

struct Judged {
  std::vector<double> online, clip;
};

Judged judge(const std::vector<Keypoints3D>& frames) {
  Judged judged;
  KeypointSides sides;
  std::vector<const Keypoints3D*> all;
  std::vector<int64_t> times;
  for (size_t t = 0; t < frames.size(); ++t) {
    judged.online.push_back(sides.step(frames[t], t == 0 ? 0 : 1e-9 * static_cast<double>(kFrame_ns)));
    all.push_back(&frames[t]);
    times.push_back(static_cast<int64_t>(t) * kFrame_ns);
  }
  judged.clip = exchanged_sides(all, times);
  return judged;
}

TEST(KeypointSides, FindsARunOfExchangedFrames) {
  std::vector<Keypoints3D> frames;
  Rng rng(1, 0, 0);
  for (int t = 0; t < 90; ++t) frames.push_back(facing(0.4 + 0.15 * rng.normal(), t >= 30 && t < 59));
  const Judged judged = judge(frames);
  for (size_t t = 0; t < frames.size(); ++t) {
    const bool truth = t >= 30 && t < 59;
    EXPECT_EQ(judged.online[t] > kExchanged, truth) << t;
    EXPECT_EQ(judged.clip[t] > kExchanged, truth) << t;
  }
}

// A whole turn in two seconds.
TEST(KeypointSides, LeavesATurningBodyUnchanged) {
  std::vector<Keypoints3D> frames;
  Rng rng(2, 0, 0);
  for (int t = 0; t < 60; ++t) frames.push_back(facing(2 * kPi * t / 60.0 + 0.1 * rng.normal()));
  const Judged judged = judge(frames);
  for (size_t t = 0; t < frames.size(); ++t) {
    EXPECT_LT(judged.online[t], kExchanged) << t;
    EXPECT_LT(judged.clip[t], kExchanged) << t;
  }
}

// Frames without anybody in the middle and at the end: each stretch is judged by itself, from both its ends.
TEST(KeypointSides, JudgesEachStretchByItself) {
  std::vector<Keypoints3D> frames;
  for (int t = 0; t < 60; ++t) frames.push_back(facing(0.4, t >= 40 && t < 50));
  for (int t = 0; t < 30; ++t) frames.emplace_back();
  for (int t = 0; t < 60; ++t) frames.push_back(facing(-0.4, t >= 45));
  for (int t = 0; t < 30; ++t) frames.emplace_back();
  const Judged judged = judge(frames);
  for (size_t t = 0; t < frames.size(); ++t) {
    if (t == 49) continue;  // seen from the end it is the first of its kind, and not trusted yet
    EXPECT_EQ(judged.clip[t] > kExchanged, (t >= 40 && t < 50) || (t >= 135 && t < 150)) << t;
  }
}

TEST(KeypointSides, RatesMakeNoDifference) {
  for (const int rate : {10, 30, 120, 240}) {
    KeypointSides sides;
    Rng rng(3, 0, 0);
    int wrong = 0;
    for (int t = 0; t < 3 * rate; ++t) {
      const double time = static_cast<double>(t) / rate;
      const bool truth = time >= 1 && time < 1.6;
      const double exchanged = sides.step(facing(0.2 + 0.15 * rng.normal(), truth), t == 0 ? 0 : 1.0 / rate);
      if ((exchanged > kExchanged) != truth) ++wrong;
    }
    EXPECT_LE(wrong, rate / 5) << rate;
  }
}

TEST(KeypointSides, IgnoresWhatIsNotFinite) {
  Keypoints3D broken = facing(0);
  broken.points[0].x[1] = std::numeric_limits<double>::infinity();
  EXPECT_FALSE(line_across(broken).has_value());
}

// Only the whole clip shows that its first frames were the wrong ones.
TEST(KeypointSides, OfAClipTheLongerPartIsRight) {
  std::vector<Keypoints3D> frames;
  frames.reserve(100);
  for (int t = 0; t < 100; ++t) frames.push_back(facing(0.2, t < 6));
  const Judged judged = judge(frames);
  EXPECT_GT(judged.clip[2], kExchanged);
  EXPECT_LT(judged.clip[50], kExchanged);
}

TEST(KeypointSides, SaysNothingWithoutHipsOrShoulders) {
  Keypoints3D some = facing(0);
  some.points.pop_back();
  EXPECT_FALSE(line_across(some).has_value());
  KeypointSides sides;
  EXPECT_EQ(sides.step(some, 0.03), 0);
  EXPECT_EQ(sides.step({}, 0.03), 0);
}

}  // namespace
}  // namespace silpose
