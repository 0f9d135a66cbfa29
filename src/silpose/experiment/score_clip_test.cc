#include "silpose/experiment/score_clip.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "silpose/body/human_profile.h"
#include "silpose/body/test_body.h"

namespace silpose {
namespace {

constexpr double kShin = 0.4;  // m

// Two hips, and a leg on the right one that bends at the knee: root_tx and right_shin_rx. No mesh.
BodyModel make_leg() {
  std::vector<Joint> joints = {
      {.name = "root", .parent_idx = -1, .offset_in_parent = {0, 1, 0}, .dof_indices = {0}},
      {.name = "right_thigh", .parent_idx = 0, .offset_in_parent = {-0.1, 0, 0}},
      {.name = "right_shin", .parent_idx = 1, .offset_in_parent = {0, -0.45, 0}, .dof_indices = {1}},
      {.name = "right_foot", .parent_idx = 2, .offset_in_parent = {0, -kShin, 0}},
      {.name = "left_thigh", .parent_idx = 0, .offset_in_parent = {0.1, 0, 0}},
  };
  std::vector<Dof> dofs = {{.name = "root_tx", .joint_idx = 0, .is_translation = true, .lower = -10, .upper = 10},
                           {.name = "right_shin_rx", .joint_idx = 2, .lower = 0, .upper = 3}};
  BodyModel body{
      .name = "leg", .skeleton = Skeleton("leg", std::move(joints), std::move(dofs)), .joint_from_rest = {5, Rigid3()}};
  body.profile = human_profile(body.skeleton);
  return body;
}

// The true leg is bent by 30 degrees in all frames.
constexpr double kTrueBend_deg = 30;

ClipTruth truth_of(const BodyModel& leg, int num_frames) {
  ClipTruth truth;
  truth.joints.emplace().joints.emplace();
  const std::vector<double> pose = {0, to_radians(kTrueBend_deg)};
  const auto names = landmark_names(leg);
  const auto places = landmark_positions(leg, pose);
  for (int t = 0; t < num_frames; ++t) {
    for (size_t i = 1; i < names.size(); ++i) {  // not the root: truths have limbs
      truth.joints->joints->rows.push_back(
          {.frame = t, .time_s = t / 10.0, .joint = names[i], .x_in_world = places[i], .pixel = {1, 2}});
    }
  }
  return truth;
}

// A leg bent by this much more than the true one, `tx` m off to the side, with these claims.
StepReport report_of(int frame, double more_deg, double tx, double knee_sd_deg, double foot_sd_m) {
  StepReport report;
  report.frame_idx = frame;
  report.time_ns = int64_t{100'000'000} * frame;
  report.pose = {tx, to_radians(kTrueBend_deg + more_deg)};
  report.spread = {0.1, to_radians(knee_sd_deg)};
  report.landmark_spread_about_root.assign(5, Eigen::Vector3d::Constant(1e-3));
  report.landmark_spread_about_root[3].setConstant(foot_sd_m);
  report.visual_accuracy = 0.9;
  return report;
}

// How far the foot is off, mm, where the knee is bent by this much too far.
double foot_mm(double more_deg) { return 1000 * 2 * kShin * std::sin(to_radians(more_deg) / 2); }

const std::vector<PinholeCamera> kCameras = {default_camera(640, 480)};

TEST(ScoreClip, KneesAndJointsByHand) {
  const BodyModel leg = make_leg();
  // Two frames, 5 degrees too far; 4 and 2 degrees are claimed: 1.645 x 4 holds it, 1.645 x 2 does not.
  const std::vector<StepReport> reports = {report_of(0, 5, 0.3, 4, 1), report_of(1, 5, 0.3, 2, 1)};
  const RunResult run = score_clip(truth_of(leg, 2), leg, kCameras, reports).value();
  EXPECT_NEAR(run.scores.at("knee_error_deg"), 5, 1e-9);
  EXPECT_NEAR(run.scores.at("joint_error_root_mm"), foot_mm(5) / 4, 1e-9);
  EXPECT_NEAR(run.scores.at("worst_frame_mm"), foot_mm(5) / 4, 1e-9);
  EXPECT_GT(run.scores.at("joint_error_mm"), 299);
  EXPECT_DOUBLE_EQ(run.scores.at("coverage_knee"), 0.5);
  EXPECT_DOUBLE_EQ(run.scores.at("coverage_joint"), 1);  // the shift of the root does not count
  EXPECT_NEAR(run.scores.at("joint_sd_mm"), 1000 * std::sqrt(3) * (1 + 3 * 1e-3) / 4, 1e-9);
  EXPECT_DOUBLE_EQ(run.scores.at("observed_iou"), 0.9);
  EXPECT_EQ(run.scores.at("frames"), 2);
  EXPECT_EQ(run.scores.at("lost"), 0);
  ASSERT_EQ(run.frames.size(), 2U);
  EXPECT_EQ(run.frames[1].size(), run.frame_columns.size());
  EXPECT_EQ(run.frames[1][1], 0.1);
  EXPECT_FALSE(run.scores.contains("pose_error_deg"));
  EXPECT_FALSE(run.scores.contains("surface_error_mm"));
}

TEST(ScoreClip, ClaimsThatTellTheErrorsApart) {
  const BodyModel leg = make_leg();
  std::vector<StepReport> reports;
  for (int t = 0; t < 10; ++t) reports.push_back(report_of(t, t, 0, 1, 1e-3 * (1 + t)));
  const RunResult run = score_clip(truth_of(leg, 10), leg, kCameras, reports).value();
  double sum = 0, sum_of_four = 0;
  for (int t = 0; t < 10; ++t) {
    sum += foot_mm(t) / 4;
    if (t < 4) sum_of_four += foot_mm(t) / 4;
  }
  EXPECT_NEAR(run.scores.at("risk_100_mm"), sum / 10, 1e-9);
  EXPECT_NEAR(run.scores.at("risk_40_mm"), sum_of_four / 4, 1e-9);
  EXPECT_DOUBLE_EQ(run.scores.at("roc_area_50mm"), 1);  // from 8 degrees on the foot is off by more than 50 mm
  EXPECT_GT(run.scores.at("rank_correlation"), 0.9);
  EXPECT_LT(run.scores.at("coverage_joint"), 1);
}

TEST(ScoreClip, FramesWithoutAPoseOrATruth) {
  const BodyModel leg = make_leg();
  std::vector<StepReport> reports = {report_of(0, 5, 0, 4, 1), report_of(1, 5, 0, 4, 1), report_of(2, 90, 0, 4, 1)};
  reports[1].pose.clear();
  reports[1].spread.clear();
  reports[1].landmark_spread_about_root.clear();
  const RunResult run = score_clip(truth_of(leg, 2), leg, kCameras, reports).value();
  EXPECT_EQ(run.frames.size(), 3U);
  EXPECT_EQ(run.scores.at("frames_missing"), 1);
  EXPECT_NEAR(run.scores.at("knee_error_deg"), 5, 1e-9);
}

TEST(ScoreClip, SurfacesByTheNearestVertex) {
  const BodyModel balls = make_ball_body();
  StepReport report;
  report.frame_idx = 3;
  report.pose = {0.5, 0, 0};
  ClipTruth truth;
  truth.surfaces = {{3, skin_vertices(balls, report.pose)}};
  truth.surfaces[0].points.resize(101);
  for (size_t i = 0; i < 101; ++i) truth.surfaces[0].points[i].y() += i < 60 ? 0.002F : 0.004F;
  StepReport other = report;  // a frame without a surface
  other.frame_idx = 4;
  const RunResult run = score_clip(truth, balls, kCameras, std::vector<StepReport>{report, other}).value();
  EXPECT_NEAR(run.scores.at("surface_median_mm"), 2, 1e-3);
  EXPECT_NEAR(run.scores.at("surface_error_mm"), (60 * 2 + 41 * 4) / 101.0, 1e-3);
  EXPECT_FALSE(run.scores.contains("lost"));
  EXPECT_FALSE(run.scores.contains("joint_error_mm"));
  EXPECT_TRUE(std::isnan(run.frames[1].at(run.frames[1].size() - 2)));
}

TEST(ScoreKeypoints, AreTurnedIntoTheWorldsAxes) {
  const BodyModel leg = make_leg();
  const PinholeCamera camera = look_at_camera(640, 480, 700, {3, 2, 4}, {0, 1, 0});
  const auto names = landmark_names(leg);
  const auto places = landmark_positions(leg, std::vector<double>{0, to_radians(kTrueBend_deg + 5)});
  Observation seen;
  seen.keypoints_3d.centre_x = camera.cx;
  seen.keypoints_3d.centre_y = camera.cy;
  for (size_t i = 1; i < names.size(); ++i) {
    const Eigen::Vector3d x = camera.cam_from_world.rotation * (places[i] - Eigen::Vector3d(0, 1, 0));
    seen.keypoints_3d.points.push_back({names[i], {x.x(), x.y(), x.z()}, 1});
  }
  seen.keypoints_3d.points.push_back({"nose", {0, 0, 0}, 1});
  seen.keypoints_2d = {{"right_shin", 4, 6, 1}};  // the truth's are at (1, 2)
  const std::vector<ClipInstant> clip = {{0, 0, {seen}}, {1, 100'000'000, {Observation()}}};
  const RunResult run = score_keypoints(truth_of(leg, 2), leg, camera, clip).value();
  EXPECT_NEAR(run.scores.at("knee_error_deg"), 5, 1e-6);
  EXPECT_NEAR(run.scores.at("joint_error_root_mm"), foot_mm(5) / 4, 1e-6);
  EXPECT_NEAR(run.scores.at("joint_error_px"), 5, 1e-9);
  EXPECT_EQ(run.scores.at("frames_missing"), 1);
  EXPECT_FALSE(run.scores.contains("joint_error_mm"));
  EXPECT_FALSE(run.scores.contains("coverage_joint"));
  ClipTruth surfaces;
  surfaces.surfaces = {{0, {Eigen::Vector3f::Zero()}}};
  EXPECT_FALSE(score_keypoints(surfaces, leg, camera, clip).ok());
}

}  // namespace
}  // namespace silpose
