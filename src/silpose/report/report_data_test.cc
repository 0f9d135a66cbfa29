#include "silpose/report/report_data.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>

#include "silpose/base/rng.h"
#include "silpose/report/recording_for_test.h"

namespace silpose {
namespace {

using nlohmann::json;
using testing::DoubleNear;
using testing::HasSubstr;
using testing::Not;

// What a page makes of a series; gaps are empty.
std::vector<std::optional<double>> unpacked(const json& series) {
  std::vector<std::optional<double>> values;
  int64_t last = 0;
  for (const json& delta : series["deltas"]) {
    if (delta.is_null()) {
      values.emplace_back();
      continue;
    }
    last += delta.get<int64_t>();
    values.emplace_back(static_cast<double>(last) * series["step"].get<double>());
  }
  return values;
}

class ReportData : public testing::Test {
 protected:
  json data() const { return json::parse(report_json({.recording = &recording, .body = &body, .overlay_video = {}})); }

  BodyModel body = arm_body();
  TrackRecording recording = three_frames();
};

TEST_F(ReportData, ShowsDegreesMetresAndGaps) {
  const json parsed = data();
  EXPECT_EQ(parsed["state"], "wtc");
  EXPECT_EQ(parsed["frame"]["deltas"], (json{60, 1, 1}));
  EXPECT_EQ(parsed["accuracy"]["deltas"], (json{nullptr, 8750, nullptr}));  // 1e-4 each
  EXPECT_EQ(parsed["n_eff"]["deltas"], (json{nullptr, 1000, nullptr}));
  EXPECT_EQ(parsed["trust"][0]["camera"], "front");
  EXPECT_EQ(parsed["trust"][0]["values"]["deltas"], (json{0, 750, nullptr}));
  const json& move = parsed["dofs"][0];
  EXPECT_EQ(move["values"]["deltas"], (json{nullptr, 5000, 0}));
  EXPECT_EQ(move["half"]["deltas"], (json{nullptr, 33, 33}));  // 32.9 and 65.8 mm
  EXPECT_EQ(move["unit"], "m");
  EXPECT_EQ(move["group"], "root");
  EXPECT_TRUE(parsed["dofs"][1]["limits"].is_null());
  const json& bend = parsed["dofs"][2];
  EXPECT_EQ(bend["values"]["deltas"], (json{nullptr, 3000, 0}));
  EXPECT_EQ(bend["limits"], (json{0.0, 90.0}));
  EXPECT_EQ(bend["side"], "right");
  EXPECT_EQ(bend["joint"], "right_elbow");
}

TEST_F(ReportData, TheSkeletonIsJointsThenEnds) {
  const json skeleton = data()["skeleton"];
  EXPECT_EQ(skeleton["names"], (json{"root", "right_elbow", "right_tip"}));
  EXPECT_EQ(skeleton["parents"], (json{-1, 0, 1}));
  EXPECT_EQ(skeleton["positions"][1][0]["deltas"], (json{nullptr, 500, 0}));
  EXPECT_EQ(skeleton["positions"][1][1]["deltas"], (json{nullptr, -300, 0}));
  EXPECT_EQ(skeleton["positions"][2][2]["deltas"], (json{nullptr, -100, 0}));  // 0.2 m, bent by 30 degrees about x
}

TEST_F(ReportData, IsOffByHalfAStepAtMostHoweverLong) {
  Rng rng(3);
  recording.steps.clear();
  for (int i = 0; i < 2000; ++i) {
    RecordedStep step{.frame_idx = i, .time_ns = i * 33'333'333LL, .state = StepReport::State::kTracked};
    step.pose = {rng.uniform(-1, 1), rng.uniform(-4, 4), rng.uniform(0, 1.5)};
    step.spread = {rng.uniform(0, 1), rng.uniform(0, 1), rng.uniform(0, 1)};
    if (i % 7 == 3) step.pose.clear();
    recording.steps.push_back(std::move(step));
  }
  const json parsed = data();
  for (size_t d = 0; d < 3; ++d) {
    const double scale = d == 0 ? 1 : to_degrees(1), step = d == 0 ? kLengthStepM : kAngleStepDeg;
    const auto values = unpacked(parsed["dofs"][d]["values"]), half = unpacked(parsed["dofs"][d]["half"]);
    ASSERT_EQ(values.size(), 2000u);
    for (size_t i = 0; i < values.size(); ++i) {
      const RecordedStep& truth = recording.steps[i];
      ASSERT_EQ(values[i].has_value(), !truth.pose.empty());
      if (values[i]) {
        ASSERT_THAT(*values[i], DoubleNear(truth.pose[d] * scale, 0.5001 * step));
      }
      ASSERT_THAT(half[i].value(), DoubleNear(1.645 * truth.spread[d] * scale, 5.001 * step));
    }
  }
  const auto height = unpacked(parsed["skeleton"]["positions"][2][1]);
  const Eigen::Vector3d tip = landmark_positions(body, recording.steps[1999].pose)[2];
  EXPECT_THAT(height[1999].value(), DoubleNear(tip.y(), 0.5001 * kPositionStepM));
}

TEST_F(ReportData, WhatIsNotANumberIsAGap) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();
  recording.steps[1].pose = {kNan, kInfinity, -1e300};
  recording.steps[1].spread = {kInfinity, kNan, 0};
  recording.steps[1].trust = {kNan};
  recording.steps[1].visual_accuracy = kNan;
  ReportInput input{.recording = &recording, .body = &body, .overlay_video = {}};
  input.stages_s = {{"decode", kNan}};
  input.viewpoint = Eigen::Vector3d(kNan, 0, 1);
  const std::string text = report_json(input);
  EXPECT_THAT(text, Not(HasSubstr("nan")));
  EXPECT_THAT(text, Not(HasSubstr("inf")));
  const json parsed = json::parse(text);
  EXPECT_EQ(parsed["dofs"][0]["values"]["deltas"], (json{nullptr, nullptr, 5000}));
  EXPECT_EQ(parsed["dofs"][2]["values"]["deltas"], (json{nullptr, nullptr, 3000}));
  EXPECT_EQ(parsed["dofs"][1]["half"]["deltas"], (json{nullptr, nullptr, 0}));
  EXPECT_TRUE(parsed["skeleton"]["positions"][2][1]["deltas"][1].is_null());
  EXPECT_EQ(parsed["stages"][0], (json{"decode", nullptr}));
}

TEST_F(ReportData, ExamplesOfMasksAreImagesInside) {
  ReportInput input{.recording = &recording, .body = &body, .overlay_video = {}};
  input.strips = {{"front", {{.frame_idx = 61, .time_s = 2.5, .width = 240, .height = 120, .jpeg = "Man"}}}};
  const json strip = json::parse(report_json(input))["strips"][0];
  EXPECT_EQ(strip["camera"], "front");
  EXPECT_EQ(strip["examples"][0]["image"], "data:image/jpeg;base64,TWFu");
  EXPECT_EQ(strip["examples"][0]["time"], 2.5);
}

}  // namespace
}  // namespace silpose
