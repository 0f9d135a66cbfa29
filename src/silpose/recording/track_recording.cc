#include "silpose/recording/track_recording.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "silpose/base/check.h"
#include "silpose/geometry/rigid3.h"

namespace silpose {
namespace {

double seconds(const RecordedStep& step) { return static_cast<double>(step.time_ns) * 1e-9; }

bool was_compared(const RecordedStep& step) {
  return step.state == StepReport::State::kTracked || step.state == StepReport::State::kInitialised;
}

template <class Values>
PoseTable table_of(const TrackRecording& recording, bool has_scores, const Values& values) {
  PoseTable table;
  table.has_scores = has_scores;
  for (const RecordedStep& step : recording.steps) {
    if (step.pose.empty()) continue;
    table.rows.push_back({.frame = step.frame_idx,
                          .time_s = seconds(step),
                          .values = values(step),
                          .visual_accuracy = step.visual_accuracy,
                          .effective_sample_size = step.effective_sample_size});
  }
  return table;
}

}  // namespace

TrackRecording recording_of(std::span<const StepReport> reports, const std::string& skeleton,
                            const std::vector<std::string>& cameras) {
  TrackRecording recording{.skeleton = skeleton, .steps = {}, .cameras = cameras};
  for (const StepReport& report : reports) {
    RecordedStep& step = recording.steps.emplace_back();
    step.frame_idx = report.frame_idx;
    step.time_ns = report.time_ns;
    step.state = report.state;
    step.pose = report.pose;
    step.mode = report.mode;
    step.spread = report.spread;
    step.landmark_spread = report.landmark_spread;
    step.visual_accuracy = report.visual_accuracy;
    step.effective_sample_size = report.effective_sample_size;
    check(report.trust.size() <= cameras.size(), "recording_of: {} cameras in a report, {} names", report.trust.size(),
          cameras.size());
    step.trust.assign(cameras.size(), std::numeric_limits<double>::quiet_NaN());
    for (size_t c = 0; c < report.trust.size(); ++c) step.trust[c] = report.trust[c].overall;
  }
  return recording;
}

std::string_view state_name(StepReport::State state) {
  switch (state) {
    case StepReport::State::kWaiting:
      return "waiting";
    case StepReport::State::kInitialised:
      return "initialised";
    case StepReport::State::kTracked:
      return "tracked";
    case StepReport::State::kCoasted:
      return "coasted";
  }
  return "waiting";
}

PoseTable pose_table(const TrackRecording& recording) {
  return table_of(recording, true, [](const RecordedStep& step) { return step.pose; });
}

PoseTable normalised_pose_table(const TrackRecording& recording, const Skeleton& skeleton) {
  return table_of(recording, true, [&](const RecordedStep& step) { return skeleton.normalise(step.pose); });
}

PoseTable spread_table(const TrackRecording& recording) {
  return table_of(recording, false, [](const RecordedStep& step) { return step.spread; });
}

JointTable joint_table(const TrackRecording& recording, const BodyModel& body, const PinholeCamera& camera) {
  const std::vector<std::string> names = landmark_names(body);
  const auto num_joints = static_cast<size_t>(body.skeleton.num_joints());
  JointTable table;
  table.has_spread = true;
  for (const RecordedStep& step : recording.steps) {
    if (step.pose.empty()) continue;
    const std::vector<Eigen::Vector3d> positions = landmark_positions(body, step.pose);
    check(step.landmark_spread.size() == positions.size(), "joint_table: {} spreads for {} landmarks",
          step.landmark_spread.size(), positions.size());
    for (size_t i = 0; i < positions.size(); ++i) {
      if (i >= num_joints && !body.profile.has_landmark(names[i])) continue;
      constexpr double kUnseen = std::numeric_limits<double>::quiet_NaN();
      table.rows.push_back({.frame = step.frame_idx,
                            .time_s = seconds(step),
                            .joint = names[i],
                            .x_in_world = positions[i],
                            .pixel = camera.project(positions[i]).value_or(Eigen::Vector2d(kUnseen, kUnseen)),
                            .sd = step.landmark_spread[i]});
    }
  }
  return table;
}

MarkerTable marker_table(const TrackRecording& recording, const BodyModel& body) {
  MarkerTable table{.names = landmark_names(body)};
  for (const RecordedStep& step : recording.steps) {
    MarkerTable::Row row{.frame = step.frame_idx, .time_s = seconds(step)};
    if (was_compared(step)) row.x_in_world = landmark_positions(body, step.pose);
    table.rows.push_back(std::move(row));
  }
  return table;
}

std::vector<std::vector<double>> even_poses(const TrackRecording& recording, const Skeleton& skeleton, double fps) {
  check(fps > 0, "even_poses: {} per second", fps);
  constexpr int64_t kSame_ns = 10'000;
  std::vector<std::vector<double>> poses;
  const RecordedStep* before = nullptr;
  int64_t start_ns = 0;
  const auto next_ns = [&] { return start_ns + std::llround(static_cast<double>(poses.size()) * 1e9 / fps); };
  for (const RecordedStep& step : recording.steps) {
    if (step.pose.empty()) continue;
    if (before == nullptr) start_ns = step.time_ns;
    for (; next_ns() < step.time_ns - kSame_ns;) {
      const double share =
          static_cast<double>(next_ns() - before->time_ns) / static_cast<double>(step.time_ns - before->time_ns);
      std::vector<double> pose = before->pose;
      for (size_t d = 0; d < pose.size(); ++d) {
        const double change = step.pose[d] - pose[d];
        pose[d] += share * (skeleton.dofs()[d].is_periodic ? wrap_angle(change) : change);
      }
      poses.push_back(std::move(pose));
    }
    if (next_ns() <= step.time_ns + kSame_ns) poses.push_back(step.pose);
    before = &step;
  }
  return poses;
}

RecordingSummary summarise(const TrackRecording& recording) {
  RecordingSummary summary;
  summary.frames = static_cast<int64_t>(recording.steps.size());
  double sum = 0, sum_of_squares = 0;
  for (const RecordedStep& step : recording.steps) {
    if (step.state == StepReport::State::kCoasted) ++summary.frames_coasted;
    if (!was_compared(step)) continue;
    ++summary.frames_tracked;
    sum += step.visual_accuracy;
    sum_of_squares += step.visual_accuracy * step.visual_accuracy;
  }
  const auto count = static_cast<double>(summary.frames_tracked);
  summary.visual_accuracy_mean = sum / count;  // 0 / 0 is NaN
  summary.visual_accuracy_std =
      std::sqrt(std::max(0.0, sum_of_squares / count - summary.visual_accuracy_mean * summary.visual_accuracy_mean));
  if (summary.frames_tracked == 0) summary.visual_accuracy_std = summary.visual_accuracy_mean;
  return summary;
}

}  // namespace silpose
