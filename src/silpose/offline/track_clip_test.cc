#include "silpose/offline/track_clip.h"

#include <gtest/gtest.h>

#include <cmath>

#include "silpose/body/test_body.h"
#include "silpose/offline/smoother.h"
#include "silpose/render/silhouette.h"
#include "silpose/track/keypoint_sides.h"
#include "silpose/track/keypoints_for_test.h"
#include "silpose/track/tracker_presets.h"

namespace silpose {
namespace {

std::vector<const ClipInstant*> pointers(std::span<const ClipInstant> clip) {
  std::vector<const ClipInstant*> instants;
  for (const ClipInstant& instant : clip) instants.push_back(&instant);
  return instants;
}

class ClipTest : public ::testing::Test {
 protected:
  static std::vector<double> truth(int t) { return {0.01 * t, 0.5, 0, 0, 0, 0.4 * std::sin(0.15 * t), 0, 0}; }
  ClipInstant instant(int t, bool seen = true) const {
    ClipInstant instant{.frame_idx = t, .time_ns = t * int64_t{33'333'333}, .observations = {{}}};
    Observation& observation = instant.observations.front();
    observation.mask = seen ? render_silhouette(*body_, camera_, truth(t)) : Mask(camera_.width, camera_.height);
    observation.trust.nothing_found = !seen;
    return instant;
  }
  // Nothing is seen from frame `gap_begin` to `gap_end`.
  std::vector<ClipInstant> clip(int num_frames, int gap_begin, int gap_end) const {
    std::vector<ClipInstant> instants;
    for (int t = 0; t < num_frames; ++t) instants.push_back(instant(t, t < gap_begin || t >= gap_end));
    return instants;
  }
  TrackerOptions accurate() const {
    TrackerOptions options = accurate_preset();
    options.body = body_;
    options.cameras = {camera_};
    options.initial_pose = truth(0);
    return options;
  }

  std::shared_ptr<const BodyModel> body_ = std::make_shared<BodyModel>(make_test_body());
  PinholeCamera camera_ = look_at_camera(320, 240, 300, {0, 1.2, 4.5}, {0, 0.75, 0});
};

TEST_F(ClipTest, SmoothingBridgesAGapAndKnowsItLess) {
  const CoverageLikelihood likelihood(body_, {camera_});
  const auto instants = clip(15, 6, 10);
  std::vector<bool> seen;
  std::vector<Eigen::VectorXd> poses;
  for (int t = 0; t < 15; ++t) {
    seen.push_back(t < 6 || t >= 10);
    std::vector<double> pose = truth(t);
    pose[0] += t % 2 == 0 ? 0.03 : -0.03;  // shaken
    pose[5] += t % 3 == 0 ? 0.1 : -0.05;
    if (!seen.back()) pose = truth(5);
    poses.emplace_back(Eigen::Map<const Eigen::VectorXd>(pose.data(), std::ssize(pose)));
  }
  const SmoothedPoses smoothed = smooth_poses(likelihood, {body_, true}, pointers(instants), seen, poses, {});
  ASSERT_EQ(smoothed.poses.size(), 15u);
  for (int t = 0; t < 15; ++t) {
    EXPECT_NEAR(smoothed.poses[static_cast<size_t>(t)][0], truth(t)[0], 0.02) << t;
    EXPECT_NEAR(smoothed.poses[static_cast<size_t>(t)][5], truth(t)[5], 0.12) << t;
  }
  EXPECT_GT(smoothed.covariances[8](5, 5), 1.5 * smoothed.covariances[3](5, 5));
}

// The matrix is the motion prior's alone: an inner frame lies between its neighbours and is known better than the ends.
TEST_F(ClipTest, WithoutSilhouettesTheMiddleIsKnownBest) {
  const CoverageLikelihood likelihood(body_, {camera_});
  const auto instants = clip(7, 0, 7);
  const std::vector<double> pose = truth(0);
  const std::vector<Eigen::VectorXd> poses(7, Eigen::Map<const Eigen::VectorXd>(pose.data(), std::ssize(pose)));
  const SmoothedPoses smoothed =
      smooth_poses(likelihood, {body_, true}, pointers(instants), std::vector<bool>(7, false), poses, {});
  for (const int t : {0, 6})
    EXPECT_GT(smoothed.covariances[static_cast<size_t>(t)](5, 5), smoothed.covariances[3](5, 5));
  EXPECT_NEAR(smoothed.covariances[0](5, 5), smoothed.covariances[6](5, 5), 1e-6 * smoothed.covariances[0](5, 5));
  EXPECT_NEAR(smoothed.covariances[2](5, 5), smoothed.covariances[4](5, 5), 1e-6 * smoothed.covariances[2](5, 5));
}

TEST_F(ClipTest, WhatStandsDoesNotSlide) {
  const CoverageLikelihood likelihood(body_, {camera_});
  const auto instants = clip(9, 0, 9);
  std::vector<Eigen::VectorXd> poses;
  for (int t = 0; t < 9; ++t) {
    poses.emplace_back(Eigen::VectorXd::Zero(8));
    poses.back()[0] = 0.006 * t;
    poses.back()[1] = 0.5;
  }
  const auto slide = [&](bool floor) {
    const auto smoothed =
        smooth_poses(likelihood, {body_, floor}, pointers(instants), std::vector<bool>(9, false), poses, {});
    return smoothed.poses[8][0] - smoothed.poses[0][0];
  };
  EXPECT_NEAR(slide(false), 0.048, 0.005);
  EXPECT_NEAR(slide(true), 0, 0.005);
}

TEST_F(ClipTest, AccurateReportsEveryInstant) {
  const auto reports = track_clip(accurate(), clip(12, 5, 7));
  ASSERT_EQ(reports.size(), 12u);
  for (int t = 0; t < 12; ++t) {
    const StepReport& report = reports[static_cast<size_t>(t)];
    EXPECT_EQ(report.frame_idx, t);
    EXPECT_EQ(report.state, t == 0             ? StepReport::State::kInitialised
                            : t == 5 || t == 6 ? StepReport::State::kCoasted
                                               : StepReport::State::kTracked);
    EXPECT_NEAR(report.pose[0], truth(t)[0], 0.03);
  }
}

TEST_F(ClipTest, NothingSeenIsWaiting) {
  for (const StepReport& report : track_clip(accurate(), clip(3, 0, 3))) {
    EXPECT_EQ(report.state, StepReport::State::kWaiting);
    EXPECT_TRUE(report.pose.empty());
  }
}

TEST_F(ClipTest, WithoutTheEvidenceThatIsUsedItIsWaiting) {
  TrackerOptions options = accurate();
  options.evidence = EvidenceKind::kKeypoints;
  options.landmarks = true;
  for (const StepReport& report : track_clip(options, clip(3, 9, 9))) {
    EXPECT_EQ(report.state, StepReport::State::kWaiting);
    EXPECT_EQ(report.observed.size(), 1u);
  }
}

TEST_F(ClipTest, StopsWhenAskedAndTellsGrowingProgress) {
  size_t last = 0, calls = 0;
  track_clip(accurate(), clip(6, 0, 0), [&](size_t done, size_t total) {
    EXPECT_GE(done, last);
    EXPECT_LE(done, total + 1);
    last = done;
    ++calls;
    return true;
  });
  EXPECT_GT(calls, 6u);
  EXPECT_TRUE(track_clip(accurate(), clip(6, 0, 0), [](size_t, size_t) { return false; }).empty());
}

// Stopped after any instant of any pass, and while smoothing, another call resumes and gives the same reports.
TEST_F(ClipTest, GoesOnFromWhereItWasStoppedBitForBit) {
  const auto instants = clip(6, 3, 4);
  for (const bool smooth : {true, false}) {
    TrackerOptions options = accurate();
    options.fitted()->smooth = smooth;
    const std::vector<StepReport> whole = track_clip(options, instants);
    ASSERT_EQ(whole.size(), 6u);
    for (const int stop : smooth ? std::vector<int>{1, 3, 8, 12, 17, 19} : std::vector<int>{1, 4}) {
      std::string state;
      ClipResume resume{.state = {}, .keep = [&](const auto& get_state) { state = get_state(); }};
      int asked = 0;
      const auto stopped = track_clip(
          options, instants, [&](size_t, size_t) { return ++asked < stop; }, resume);
      ASSERT_LT(stopped.size(), 6u) << stop;
      ASSERT_FALSE(state.empty()) << stop;
      int left = 0;
      resume.state = state;
      const auto found = track_clip(
          options, instants, [&](size_t, size_t) { return ++left > 0; }, resume);
      EXPECT_GT(asked + left, stop) << stop;
      // 18 steps at most, 12 iterations of the smoother: none of those before the stop is taken again.
      EXPECT_LT(left, 33 - stop) << stop;
      ASSERT_EQ(found.size(), whole.size()) << stop;
      for (size_t t = 0; t < found.size(); ++t) {
        EXPECT_EQ(found[t].pose, whole[t].pose) << stop << ", " << t;
        EXPECT_EQ(found[t].spread, whole[t].spread) << stop << ", " << t;
        EXPECT_EQ(found[t].state, whole[t].state) << stop << ", " << t;
        EXPECT_EQ(found[t].observed, whole[t].observed) << stop << ", " << t;
      }
    }
  }
}

TEST_F(ClipTest, RefusesAStateOfAnotherClip) {
  std::string state;
  const ClipResume keep{.state = {}, .keep = [&](const auto& get_state) { state = get_state(); }};
  track_clip(
      accurate(), clip(4, 9, 9), [&](size_t, size_t) { return state.empty(); }, keep);
  EXPECT_THROW(track_clip(accurate(), clip(3, 9, 9), {}, {.state = state, .keep = {}}), std::invalid_argument);
}

// A body of two sides, turned 0.6 rad, whose network exchanges left and right in frames 4 to 6 of 9.
class ExchangedClipTest : public ClipTest {
 protected:
  static bool is_exchanged(size_t t) { return t >= 4 && t <= 6; }
  ExchangedClipTest() {
    body_ = std::make_shared<BodyModel>(make_sided_body());
    for (int t = 0; t < 9; ++t) {
      std::vector<double> pose = truth(t);
      pose[3] = 0.6;
      clip_.push_back({.frame_idx = t, .time_ns = t * int64_t{33'333'333}, .observations = {{}}});
      Observation& seen = clip_.back().observations.front();
      seen.mask = render_silhouette(*body_, camera_, pose);
      add_keypoints(*body_, camera_, pose, seen, is_exchanged(static_cast<size_t>(t)));
    }
  }
  TrackerOptions by_keypoints(bool smooth) const {
    TrackerOptions options = accurate();
    options.initial_pose.reset();
    options.fitted()->smooth = smooth;
    options.evidence = EvidenceKind::kBoth;
    options.landmarks = true;
    options.fitted()->num_hypotheses = 2;
    return options;
  }

  std::vector<ClipInstant> clip_;
};

// Bit for bit as if the network had found no keypoints in those frames.
TEST_F(ExchangedClipTest, ExchangedKeypointsDoNotCount) {
  std::vector<ClipInstant> without = clip_;
  for (size_t t = 0; t < without.size(); ++t) {
    if (!is_exchanged(t)) continue;
    without[t].observations[0].keypoints_3d = {};
    without[t].observations[0].keypoints_2d.clear();
  }
  const std::vector<StepReport> found = track_clip(by_keypoints(true), clip_),
                                expected = track_clip(by_keypoints(true), without);
  ASSERT_EQ(found.size(), clip_.size());
  for (size_t t = 0; t < found.size(); ++t) {
    EXPECT_EQ(found[t].exchanged > kExchanged, is_exchanged(t)) << t;
    EXPECT_EQ(expected[t].exchanged > kExchanged, false) << t;
    EXPECT_EQ(found[t].pose, expected[t].pose) << t;
    EXPECT_EQ(found[t].spread, expected[t].spread) << t;
    EXPECT_NEAR(found[t].pose[3], 0.6, 0.3) << t;
  }
}

// Stopped before, among and after the frames that are exchanged, and in other passes.
TEST_F(ExchangedClipTest, GoesOnFromWhereItWasStoppedBitForBit) {
  for (const bool smooth : {true, false}) {
    const TrackerOptions options = by_keypoints(smooth);
    const std::vector<StepReport> whole = track_clip(options, clip_);
    ASSERT_EQ(whole.size(), clip_.size());
    for (const int stop : smooth ? std::vector<int>{5, 14, 27} : std::vector<int>{3, 5, 7, 8}) {
      std::string state;
      ClipResume resume{.state = {}, .keep = [&](const auto& get_state) { state = get_state(); }};
      int asked = 0;
      const auto stopped = track_clip(
          options, clip_, [&](size_t, size_t) { return ++asked < stop; }, resume);
      ASSERT_LT(stopped.size(), clip_.size()) << stop;
      resume.state = state;
      const auto found = track_clip(options, clip_, {}, resume);
      ASSERT_EQ(found.size(), whole.size()) << stop;
      for (size_t t = 0; t < found.size(); ++t) {
        EXPECT_EQ(whole[t].exchanged > kExchanged, is_exchanged(t)) << t;
        EXPECT_EQ(found[t].exchanged, whole[t].exchanged) << stop << ", " << t;
        EXPECT_EQ(found[t].pose, whole[t].pose) << stop << ", " << t;
        EXPECT_EQ(found[t].spread, whole[t].spread) << stop << ", " << t;
        EXPECT_EQ(found[t].state, whole[t].state) << stop << ", " << t;
      }
    }
  }
}

}  // namespace
}  // namespace silpose
