#include "silpose/experiment/score_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "silpose/body/test_body.h"
#include "silpose/experiment/tracking_runs.h"
#include "silpose/synth/test_scene.h"

namespace silpose {
namespace {

// Reports of the true poses, with a spread of `spread` in everything.
std::vector<StepReport> true_reports(const SyntheticSequence& scene, double spread) {
  std::vector<StepReport> reports;
  for (int t = 0; t < scene.num_frames(); ++t) {
    StepReport report;
    report.frame_idx = t;
    const auto pose = pose_of_frame(scene, t);
    report.pose.assign(pose.begin(), pose.end());
    report.spread.assign(report.pose.size(), spread);
    report.landmark_spread.assign(landmark_names(*scene.body).size(), Eigen::Vector3d::Constant(spread));
    reports.push_back(report);
  }
  return reports;
}

TEST(ScoreRun, TheTruthScoresNothing) {
  const SyntheticSequence scene = make_test_scene();
  const RunResult run = score_run(scene, *scene.body, true_reports(scene, 0.01)).value();
  EXPECT_EQ(run.frames.size(), 20u);
  EXPECT_EQ(run.frames[3].size(), run.frame_columns.size());
  EXPECT_EQ(run.frames[3][0], 3);
  EXPECT_NEAR(run.scores.at("pose_error_npsu"), 0, 1e-12);
  EXPECT_NEAR(run.scores.at("iou"), 1, 1e-12);
  EXPECT_EQ(run.scores.at("coverage_dof"), 1);
  EXPECT_EQ(run.scores.at("coverage_joint"), 1);
  EXPECT_EQ(run.scores.at("frames_missing"), 0);
}

TEST(ScoreRun, IntervalsCountTheFramesOutsideThem) {
  const SyntheticSequence scene = make_test_scene();
  std::vector<StepReport> reports = true_reports(scene, 0.01);
  for (size_t t = 0; t < 5; ++t) reports[t].pose[0] += 0.02;  // root_tx, two spreads, in a quarter of the frames
  const RunResult run = score_run(scene, *scene.body, reports).value();
  EXPECT_DOUBLE_EQ(run.scores.at("interval_dof/root_tx"), 0.75);
  EXPECT_DOUBLE_EQ(run.scores.at("interval_dof/root_ty"), 1);
  EXPECT_DOUBLE_EQ(run.scores.at("interval_joint/tip_x"), 0.75);
  EXPECT_DOUBLE_EQ(run.scores.at("interval_joint/tip_y"), 1);
  EXPECT_DOUBLE_EQ(run.scores.at("coverage_dof"), (7 + 0.75) / 8);
}

TEST(ScoreRun, FramesWithoutAPoseAreMissingAndLostAtTheEnd) {
  const SyntheticSequence scene = make_test_scene();
  std::vector<StepReport> reports = true_reports(scene, 0.01);
  for (size_t t = 5; t < 20; ++t) {
    reports[t].pose.clear();
    reports[t].spread.clear();
    reports[t].landmark_spread.clear();
  }
  const RunResult run = score_run(scene, *scene.body, reports).value();
  EXPECT_EQ(run.scores.at("frames_missing"), 15);
  EXPECT_EQ(run.scores.at("lost"), 1);
  EXPECT_EQ(run.scores.at("in_basin"), 0);
  EXPECT_TRUE(std::isnan(run.frames[10][2]));
  EXPECT_NEAR(run.scores.at("iou"), 1, 1e-12);
}

TEST(ScoreRun, RefusesFramesThatAreNotThere) {
  const SyntheticSequence scene = make_test_scene();
  std::vector<StepReport> reports = true_reports(scene, 0.01);
  reports.back().frame_idx = 20;
  EXPECT_THROW((void)score_run(scene, *scene.body, reports), std::invalid_argument);
}

// The whole of a run, on the body made by hand.
TEST(TrackingRuns, OneSeedOneResult) {
  const BodySource bodies = [](const std::string& model) -> Result<std::shared_ptr<const BodyModel>> {
    if (model != "tube") return error("{}: no such body", model);
    return std::make_shared<const BodyModel>(make_test_body());
  };
  const auto always = [] { return true; };
  const RunSettings settings{.model = "tube",
                             .frames = 3,
                             .preset = "thesis",
                             .tracker = {{"particles", int64_t{30}}},
                             .motion = "dof:6",
                             .range = std::array<double, 2>{-10, 10},
                             .width = 80,
                             .height = 80,
                             .focal_px = 60,
                             .start = "truth"};
  TrackingRuns first(bodies, ""), second(bodies, "");
  const RunResult a = first.run(settings, 3, always).value().value();
  const RunResult b = second.run(settings, 3, always).value().value();
  for (const char* score : {"pose_error_npsu", "angle_error_deg", "iou", "coverage_joint"}) {
    EXPECT_EQ(a.scores.at(score), b.scores.at(score)) << score;
  }
  EXPECT_GT(a.scores.at("angle_error_deg"), 0);
  EXPECT_EQ(a.scores.at("mask_iou"), 1);
  EXPECT_GT(a.scores.at("frames_per_second"), 0);
  EXPECT_GT(a.scores.at("iou"), 0.5);
  EXPECT_FALSE(first.run(settings, 3, [] { return false; }).value().has_value());

  RunSettings wrong = settings;
  wrong.model = "cube";
  EXPECT_EQ(first.run(wrong, 3, always).error().message, "cube: no such body");
  wrong = settings;
  wrong.motion = "sway";
  EXPECT_THAT(first.run(wrong, 3, always).error().message, testing::HasSubstr("range"));
  wrong = settings;
  wrong.preset = "none";
  EXPECT_THAT(first.run(wrong, 3, always).error().message, testing::HasSubstr("none"));
}

}  // namespace
}  // namespace silpose
