#include "silpose/offline/judged_clip.h"

#include <gmock/gmock.h>

namespace silpose {
namespace {

constexpr int kFrames = 40, kFirst = 18, kLast = 21;  // the second camera's network exchanges left and right in these

// Hips and shoulders of a person who stands and faces the camera.
Observation seen(bool exchanged) {
  const double left = exchanged ? -1 : 1;
  Observation observation{Mask(64, 48)};
  observation.mask.set(30, 20);
  observation.keypoints_2d = {{"left_thigh", 30, 20}};
  observation.keypoints_3d.points = {{"left_thigh", {0.1 * left, 0, 0}},
                                     {"right_thigh", {-0.1 * left, 0, 0}},
                                     {"left_upper_arm", {0.2 * left, -0.5, 0}},
                                     {"right_upper_arm", {-0.2 * left, -0.5, 0}}};
  return observation;
}

TEST(JudgedClip, LeavesOutKeypointsOfTheCameraThatExchangedSides) {
  std::vector<ClipInstant> clip;
  for (int t = 0; t < kFrames; ++t) {
    clip.push_back({t, t * int64_t{33'333'333}, {seen(false), seen(t >= kFirst && t <= kLast)}});
  }
  const JudgedClip judged(clip, 2);
  ASSERT_EQ(judged.size(), clip.size());
  for (int t = 0; t < kFrames; ++t) {
    const std::vector<Observation>& observations = judged[static_cast<size_t>(t)].observations;
    const bool is_exchanged = t >= kFirst && t <= kLast;
    EXPECT_FALSE(observations[0].keypoints_3d.empty()) << t;
    EXPECT_EQ(observations[1].keypoints_3d.empty(), is_exchanged) << t;
    EXPECT_EQ(observations[1].keypoints_2d.empty(), is_exchanged) << t;
    EXPECT_EQ(observations[1].mask, clip[0].observations[1].mask);
    EXPECT_EQ(judged.exchanged(static_cast<size_t>(t)) > 0.5, is_exchanged) << t;
  }
}

TEST(JudgedClip, RefusesAnotherNumberOfCameras) {
  const std::vector<ClipInstant> clip = {{0, 0, {seen(false)}}};
  EXPECT_THROW(JudgedClip(clip, 2), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
