#include "silpose/experiment/score_parts.h"

#include <algorithm>
#include <cmath>

namespace silpose {

Recorded recorded_of(const BodyModel& body, const PinholeCamera& camera, std::span<const StepReport> reports,
                     const std::function<double(const StepReport&)>& time_s) {
  Recorded result;
  result.poses.emplace();
  result.joints.emplace();
  const std::vector<std::string> names = landmark_names(body);
  for (const StepReport& report : reports) {
    if (report.pose.empty()) continue;
    const double time = time_s(report);
    result.poses->rows.push_back({.frame = report.frame_idx, .time_s = time, .values = report.pose});
    const std::vector<Eigen::Vector3d> positions = landmark_positions(body, report.pose);
    for (size_t i = 0; i < names.size(); ++i) {
      const auto pixel = camera.project(positions[i]);
      result.joints->rows.push_back({.frame = report.frame_idx,
                                     .time_s = time,
                                     .joint = names[i],
                                     .x_in_world = positions[i],
                                     .pixel = pixel.value_or(Eigen::Vector2d(kAbsent, kAbsent))});
    }
  }
  return result;
}

void add_mean_and_deviation(const std::string& name, const std::vector<std::vector<double>>& rows, size_t column,
                            RunResult& run) {
  double sum = 0, squares = 0, count = 0;
  for (const std::vector<double>& row : rows) {
    if (std::isfinite(row[column])) sum += row[column], count += 1;
  }
  if (count == 0) return;
  for (const std::vector<double>& row : rows) {
    if (std::isfinite(row[column])) squares += (row[column] - sum / count) * (row[column] - sum / count);
  }
  run.scores[name] = sum / count;
  run.scores[name + "_sd"] = std::sqrt(squares / count);
}

void add_verdicts(const std::vector<double>& root_errors, RunResult& run) {
  const size_t last = std::min(root_errors.size(), static_cast<size_t>(kLostFrames));
  const bool lost = std::all_of(root_errors.end() - static_cast<std::ptrdiff_t>(last), root_errors.end(),
                                [](double error_mm) { return !(error_mm <= kLostMm); });
  run.scores["lost"] = lost ? 1 : 0;
  const size_t settled = std::min(root_errors.size(), static_cast<size_t>(kBasinFrames)) - 1;
  run.scores["in_basin"] = root_errors[settled] < kBasinMm ? 1 : 0;
}

double mean_of(std::span<const double> values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}

}  // namespace silpose
