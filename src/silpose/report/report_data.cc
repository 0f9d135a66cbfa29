#include "silpose/report/report_data.h"

#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "silpose/base/check.h"
#include "silpose/evaluate/interval_coverage.h"
#include "silpose/report/base64.h"
#include "silpose/report/dof_groups.h"

namespace silpose {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// What a page shows of a number. NaN has no place in JSON.
Json rounded(double value) { return std::isfinite(value) ? Json(std::round(value * 1e6) / 1e6) : Json(nullptr); }

// `value(i)` of the T steps as the header says; a gap where it is not finite.
template <class Value>
Json series(size_t count, double step, const Value& value) {
  static constexpr double kMost = 1e15;  // whole numbers up to here are exact, also in a browser
  Json deltas = Json::array();
  int64_t last = 0;
  for (size_t i = 0; i < count; ++i) {
    const double scaled = value(i) / step;
    if (!(std::abs(scaled) < kMost)) {
      deltas.push_back(nullptr);
      continue;
    }
    const int64_t whole = std::llround(scaled);
    deltas.push_back(whole - last);
    last = whole;
  }
  return {{"step", step}, {"deltas", std::move(deltas)}};
}

bool was_compared(const RecordedStep& step) {
  return step.state == StepReport::State::kTracked || step.state == StepReport::State::kInitialised;
}

void add_steps(const TrackRecording& recording, Json& data) {
  const std::vector<RecordedStep>& steps = recording.steps;
  std::string states;
  for (const RecordedStep& step : steps) states += state_name(step.state).front();
  data["state"] = states;
  data["frame"] = series(steps.size(), 1, [&](size_t i) { return static_cast<double>(steps[i].frame_idx); });
  data["time"] = series(steps.size(), 1e-4, [&](size_t i) { return static_cast<double>(steps[i].time_ns) * 1e-9; });
  data["accuracy"] = series(steps.size(), 1e-4,
                            [&](size_t i) { return was_compared(steps[i]) ? steps[i].visual_accuracy : kUnknown; });
  data["n_eff"] = series(steps.size(), 0.1,
                         [&](size_t i) { return was_compared(steps[i]) ? steps[i].effective_sample_size : kUnknown; });
  data["trust"] = Json::array();
  for (size_t c = 0; c < recording.cameras.size(); ++c) {
    data["trust"].push_back({{"camera", recording.cameras[c]}, {"values", series(steps.size(), 0.001, [&](size_t i) {
                                                                  return c < steps[i].trust.size() ? steps[i].trust[c]
                                                                                                   : kUnknown;
                                                                })}});
  }
}

Json dofs_of(const TrackRecording& recording, const Skeleton& skeleton) {
  const std::vector<RecordedStep>& steps = recording.steps;
  const std::vector<std::string> groups = dof_groups(skeleton);
  Json dofs = Json::array();
  for (size_t d = 0; d < skeleton.dofs().size(); ++d) {
    const Dof& dof = skeleton.dofs()[d];
    const double scale = dof.is_translation ? 1 : to_degrees(1);
    const double step = dof.is_translation ? kLengthStepM : kAngleStepDeg;
    const bool has_limits = !dof.is_periodic && !dof.is_translation;
    dofs.push_back(
        {{"name", dof.name},
         {"joint", skeleton.joints()[static_cast<size_t>(dof.joint_idx)].name},
         {"group", groups[d]},
         {"side", side_of(dof.name)},
         {"unit", dof.is_translation ? "m" : "°"},
         {"limits", has_limits ? Json{rounded(dof.lower * scale), rounded(dof.upper * scale)} : Json(nullptr)},
         {"values", series(steps.size(), step,
                           [&](size_t i) { return steps[i].pose.empty() ? kUnknown : steps[i].pose[d] * scale; })},
         {"half", series(steps.size(), step * kStepOfIntervals, [&](size_t i) {
            return steps[i].spread.empty() ? kUnknown : steps[i].spread[d] * scale * kSpreadsOf90Percent;
          })}});
  }
  return dofs;
}

Json skeleton_of(const TrackRecording& recording, const BodyModel& body) {
  const std::vector<RecordedStep>& steps = recording.steps;
  std::vector<std::vector<Eigen::Vector3d>> positions;
  positions.reserve(steps.size());
  for (const RecordedStep& step : steps) {
    positions.push_back(step.pose.empty() ? std::vector<Eigen::Vector3d>() : landmark_positions(body, step.pose));
  }
  Json names = landmark_names(body), parents = Json::array(), axes = Json::array();
  for (const Joint& joint : body.skeleton.joints()) parents.push_back(joint.parent_idx);
  for (const BodyModel::EndPoint& point : body.end_points) parents.push_back(point.joint_idx);
  for (size_t landmark = 0; landmark < parents.size(); ++landmark) {
    Json of_landmark = Json::array();
    for (int axis = 0; axis < 3; ++axis) {
      of_landmark.push_back(series(steps.size(), kPositionStepM, [&](size_t i) {
        return positions[i].empty() ? kUnknown : positions[i][landmark][axis];
      }));
    }
    axes.push_back(std::move(of_landmark));
  }
  return {{"names", std::move(names)}, {"parents", std::move(parents)}, {"positions", std::move(axes)}};
}

Json strips_of(const ReportInput& input) {
  Json strips = Json::array();
  for (const auto& [camera, examples] : input.strips) {
    Json images = Json::array();
    for (const MaskExample& example : examples) {
      images.push_back({{"frame", example.frame_idx},
                        {"time", rounded(example.time_s)},
                        {"width", example.width},
                        {"height", example.height},
                        {"empty", example.is_empty},
                        {"image", "data:image/jpeg;base64," + base64(example.jpeg)}});
    }
    strips.push_back({{"camera", camera}, {"examples", std::move(images)}});
  }
  return strips;
}

}  // namespace

std::string report_json(const ReportInput& input) {
  check(input.recording != nullptr && input.body != nullptr, "report_json: recording and body are wanted");
  Json data;
  data["fps"] = input.fps;
  data["facts"] = input.facts;
  data["mask_facts"] = input.mask_facts;
  data["strips"] = strips_of(input);
  data["downloads"] = input.downloads;
  data["warnings"] = input.warnings;
  data["stages"] = Json::array();
  for (const auto& [stage, seconds] : input.stages_s) data["stages"].push_back({stage, rounded(seconds)});
  add_steps(*input.recording, data);
  data["dofs"] = dofs_of(*input.recording, input.body->skeleton);
  data["skeleton"] = skeleton_of(*input.recording, *input.body);
  data["viewpoint"] = nullptr;
  if (input.viewpoint) {
    data["viewpoint"] = {rounded(input.viewpoint->x()), rounded(input.viewpoint->y()), rounded(input.viewpoint->z())};
  }
  return data.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace silpose
