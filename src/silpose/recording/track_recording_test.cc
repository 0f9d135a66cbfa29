#include "silpose/recording/track_recording.h"

#include <gtest/gtest.h>

#include <cmath>

namespace silpose {
namespace {

// One bone that hangs from the root; of its two ends one is a landmark.
BodyModel stick() {
  Joint root{.name = "root", .dof_indices = {0, 1}};
  Dof rise{.name = "root_ty", .is_translation = true, .axis = Eigen::Vector3d::UnitY(), .lower = -2, .upper = 2};
  Dof turn{.name = "root_rz", .axis = Eigen::Vector3d::UnitZ(), .lower = -kPi, .upper = kPi};
  BodyModel body{.name = "stick", .skeleton = Skeleton("stick", {root}, {rise, turn})};
  body.joint_from_rest = {Rigid3{}};
  body.end_points = {{"head_top", 0, {0, 1, 0}}, {"toe", 0, {0, -1, 0}}};
  body.profile.landmarks = {{"head_top"}};
  return body;
}

RecordedStep step(int64_t frame, const std::vector<double>& pose, StepReport::State state, double accuracy = 0) {
  RecordedStep made{.frame_idx = frame, .time_ns = frame * 100'000'000, .state = state, .pose = pose, .mode = pose};
  if (!pose.empty()) {
    made.spread = {0.1, 0.2};
    made.landmark_spread.assign(3, {0.01, 0.02, 0.03});
  }
  made.visual_accuracy = accuracy;
  return made;
}

using State = StepReport::State;

TEST(TrackRecording, TablesLeaveOutFramesWithoutPose) {
  const TrackRecording recording{"stick", {step(3, {}, State::kWaiting), step(4, {1, kPi / 2}, State::kTracked, 0.9)}};
  const PoseTable poses = pose_table(recording);
  ASSERT_EQ(poses.rows.size(), 1u);
  EXPECT_EQ(poses.rows[0].frame, 4);
  EXPECT_DOUBLE_EQ(poses.rows[0].time_s, 0.4);
  EXPECT_DOUBLE_EQ(poses.rows[0].visual_accuracy, 0.9);
  EXPECT_TRUE(poses.has_scores);
  EXPECT_FALSE(spread_table(recording).has_scores);
  EXPECT_EQ(spread_table(recording).rows[0].values, (std::vector<double>{0.1, 0.2}));
  EXPECT_EQ(normalised_pose_table(recording, stick().skeleton).rows[0].values, (std::vector<double>{0.75, 0.75}));
}

TEST(TrackRecording, JointsAreJointsAndLandmarksInWorldAndImage) {
  const TrackRecording recording{"stick", {step(0, {1, kPi / 2}, State::kTracked)}};
  const PinholeCamera camera = look_at_camera(100, 100, 100, {0, 1, 5}, {0, 1, 0});
  const JointTable joints = joint_table(recording, stick(), camera);
  ASSERT_EQ(joints.rows.size(), 2u);
  EXPECT_EQ(joints.rows[0].joint, "root");
  EXPECT_EQ(joints.rows[1].joint, "head_top");
  // Raised by 1 m and turned by a quarter: the tip points to -X, 1 m from the root, 20 px at a distance of 5 m.
  EXPECT_TRUE(joints.rows[1].x_in_world.isApprox(Eigen::Vector3d(-1, 1, 0), 1e-12));
  EXPECT_NEAR((joints.rows[1].pixel - joints.rows[0].pixel).x(), -20, 1e-9);
  EXPECT_EQ(joints.rows[1].sd, Eigen::Vector3d(0.01, 0.02, 0.03));
}

TEST(TrackRecording, AJointBehindTheCameraHasNoPixel) {
  const TrackRecording recording{"stick", {step(0, {0, 0}, State::kTracked)}};
  const JointTable joints = joint_table(recording, stick(), look_at_camera(100, 100, 100, {0, 0, 5}, {0, 0, 9}));
  EXPECT_TRUE(std::isnan(joints.rows[0].pixel.x()));
}

TEST(TrackRecording, MarkersAreBlankWhereNothingWasCompared) {
  const TrackRecording recording{"stick",
                                 {step(3, {}, State::kWaiting), step(4, {1, kPi / 2}, State::kInitialised),
                                  step(5, {1, 0}, State::kCoasted), step(6, {1, 0}, State::kTracked)}};
  const MarkerTable markers = marker_table(recording, stick());
  EXPECT_EQ(markers.names, (std::vector<std::string>{"root", "head_top", "toe"}));
  ASSERT_EQ(markers.rows.size(), 4u);
  EXPECT_TRUE(markers.rows[0].x_in_world.empty());
  ASSERT_EQ(markers.rows[1].x_in_world.size(), 3u);
  EXPECT_TRUE(markers.rows[1].x_in_world[1].isApprox(Eigen::Vector3d(-1, 1, 0), 1e-12));
  EXPECT_TRUE(markers.rows[2].x_in_world.empty());
  EXPECT_EQ(markers.rows[2].frame, 5);
  EXPECT_DOUBLE_EQ(markers.rows[2].time_s, 0.5);
  EXPECT_TRUE(markers.rows[3].x_in_world[1].isApprox(Eigen::Vector3d(0, 2, 0), 1e-12));
}

TEST(TrackRecording, EvenPosesLieBetweenThoseAroundThemInTime) {
  TrackRecording recording{
      "stick", {step(1, {}, State::kWaiting), step(2, {0.5, 0}, State::kTracked), step(4, {0.7, 0}, State::kTracked)}};
  const std::vector<std::vector<double>> even = even_poses(recording, stick().skeleton, 10);
  ASSERT_EQ(even.size(), 3u);
  EXPECT_EQ(even[0], (std::vector<double>{0.5, 0}));
  EXPECT_NEAR(even[1][0], 0.6, 1e-12);
  EXPECT_EQ(even[2], (std::vector<double>{0.7, 0}));

  // Frames at 0, 30 and 100 ms, every 50 ms: half, then 2/7 of the way, then the last itself.
  recording.steps = {step(0, {0, 0}, State::kTracked), step(1, {0.3, 0}, State::kTracked),
                     step(2, {1, 0}, State::kTracked)};
  recording.steps[1].time_ns = 30'000'000;
  recording.steps[2].time_ns = 100'000'000;
  const std::vector<std::vector<double>> uneven = even_poses(recording, stick().skeleton, 20);
  ASSERT_EQ(uneven.size(), 3u);
  EXPECT_NEAR(uneven[1][0], 0.5, 1e-12);
  EXPECT_EQ(uneven[2][0], 1);
  EXPECT_TRUE(even_poses(TrackRecording{}, stick().skeleton, 20).empty());
}

TEST(TrackRecording, SummaryCountsComparedFrames) {
  const TrackRecording recording{"stick",
                                 {step(0, {}, State::kWaiting), step(1, {0, 0}, State::kInitialised, 0.8),
                                  step(2, {0, 0}, State::kTracked, 0.6), step(3, {0, 0}, State::kCoasted)}};
  const RecordingSummary summary = summarise(recording);
  EXPECT_EQ(summary.frames, 4);
  EXPECT_EQ(summary.frames_tracked, 2);
  EXPECT_EQ(summary.frames_coasted, 1);
  EXPECT_NEAR(summary.visual_accuracy_mean, 0.7, 1e-12);
  EXPECT_NEAR(summary.visual_accuracy_std, 0.1, 1e-9);
  EXPECT_TRUE(std::isnan(summarise(TrackRecording{}).visual_accuracy_mean));
}

}  // namespace
}  // namespace silpose
