#include "silpose/recording/track_recorder.h"

#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "silpose/base/check.h"

namespace silpose {
namespace {

std::vector<double> flattened(const std::vector<Eigen::Vector3d>& points) {
  std::vector<double> values;
  for (const Eigen::Vector3d& point : points) values.insert(values.end(), {point.x(), point.y(), point.z()});
  return values;
}

std::optional<StepReport::State> state_of(std::string_view name) {
  using State = StepReport::State;
  for (const State state : {State::kWaiting, State::kInitialised, State::kTracked, State::kCoasted}) {
    if (state_name(state) == name) return state;
  }
  return std::nullopt;
}

// All entries of a path with values of type T, by time. A path that is not there has none.
template <class T>
Result<std::map<int64_t, T>> read_path(const sadb::Blackboard& board, const std::string& path) {
  std::map<int64_t, T> values;
  if (board.count(path) == 0) return values;
  auto entries = board.range(path, std::numeric_limits<int64_t>::min(), std::numeric_limits<int64_t>::max());
  if (!entries) return entries.failure();
  for (sadb::Entry& entry : *entries) {
    T* const value = std::get_if<T>(&entry.value);
    if (value == nullptr) return error("{}: holds {}", path, sadb::type_name(sadb::type_of(entry.value)));
    values.emplace_hint(values.end(), entry.time_ns, std::move(*value));
  }
  return values;
}

// The trust of every camera, by name.
Result<std::map<std::string, std::map<int64_t, double>>> read_trust(const sadb::Blackboard& board,
                                                                    const std::string& folder) {
  std::map<std::string, std::map<int64_t, double>> trust;
  for (const sadb::PathInfo& info : board.list(folder)) {
    auto values = read_path<double>(board, info.path);
    if (!values) return values.failure();
    trust[info.path.substr(folder.size() + 1)] = std::move(*values);
  }
  return trust;
}

template <class T>
T take(std::map<int64_t, T>& values, int64_t time_ns) {
  const auto found = values.find(time_ns);
  return found == values.end() ? T{} : std::move(found->second);
}

}  // namespace

TrackRecorder::TrackRecorder(std::shared_ptr<sadb::Blackboard> board, std::string skeleton,
                             std::vector<std::string> camera_names, RecorderOptions options)
    : board_(std::move(board)),
      skeleton_(std::move(skeleton)),
      camera_names_(std::move(camera_names)),
      options_(std::move(options)) {
  check(board_ != nullptr, "TrackRecorder: no board");
}

Result<void> TrackRecorder::put(const StepReport& report) {
  check(report.trust.size() <= camera_names_.size() && report.observed.size() <= camera_names_.size(),
        "TrackRecorder: {} cameras in a report, {} names", report.trust.size(), camera_names_.size());
  std::vector<std::pair<std::string, sadb::Value>> entries = {
      {"frame", static_cast<double>(report.frame_idx)},
      {"state", std::string(state_name(report.state))},
      {"visual_accuracy", report.visual_accuracy},
      {"effective_sample_size", report.effective_sample_size},
  };
  if (!report.pose.empty()) {
    entries.emplace_back("pose", sadb::Pose{skeleton_, report.pose});
    entries.emplace_back("mode", sadb::Pose{skeleton_, report.mode});
    entries.emplace_back("spread", report.spread);
    entries.emplace_back("landmark_spread", flattened(report.landmark_spread));
  }
  for (size_t c = 0; c < report.trust.size(); ++c)
    entries.emplace_back("trust/" + camera_names_[c], report.trust[c].overall);
  for (size_t c = 0; options_.masks && c < report.observed.size(); ++c) {
    entries.emplace_back("observed/" + camera_names_[c], report.observed[c]);
  }
  for (auto& [name, value] : entries) {
    Result<void> put = board_->put(options_.prefix + "/" + name, report.time_ns, std::move(value));
    if (!put) return put;
  }
  return {};
}

Result<TrackRecording> read_recording(const sadb::Blackboard& board, const std::string& prefix) {
  const auto path = [&](const char* name) { return prefix + "/" + name; };
  auto frames = read_path<double>(board, path("frame"));
  auto states = read_path<std::string>(board, path("state"));
  auto accuracies = read_path<double>(board, path("visual_accuracy"));
  auto sizes = read_path<double>(board, path("effective_sample_size"));
  auto poses = read_path<sadb::Pose>(board, path("pose"));
  auto modes = read_path<sadb::Pose>(board, path("mode"));
  auto spreads = read_path<std::vector<double>>(board, path("spread"));
  auto landmark_spreads = read_path<std::vector<double>>(board, path("landmark_spread"));
  const auto trust = read_trust(board, path("trust"));
  if (!frames) return frames.failure();
  if (!states) return states.failure();
  if (!accuracies) return accuracies.failure();
  if (!sizes) return sizes.failure();
  if (!poses) return poses.failure();
  if (!modes) return modes.failure();
  if (!spreads) return spreads.failure();
  if (!landmark_spreads) return landmark_spreads.failure();
  if (!trust) return trust.failure();
  if (frames->empty()) return error("{}: nothing is recorded there", prefix);

  TrackRecording recording;
  for (const auto& [camera, values] : *trust) recording.cameras.push_back(camera);
  for (const auto& [time_ns, frame] : *frames) {
    RecordedStep step;
    step.frame_idx = std::llround(frame);
    step.time_ns = time_ns;
    const std::string name = take(*states, time_ns);
    const std::optional<StepReport::State> state = state_of(name);
    if (!state) return error("{}: no state is called \"{}\"", path("state"), name);
    step.state = *state;
    sadb::Pose pose = take(*poses, time_ns);
    if (recording.skeleton.empty()) recording.skeleton = pose.skeleton;
    if (!pose.skeleton.empty() && pose.skeleton != recording.skeleton) {
      return error("{}: poses of {} and of {}", path("pose"), recording.skeleton, pose.skeleton);
    }
    step.pose = std::move(pose.values);
    step.mode = take(*modes, time_ns).values;
    step.spread = take(*spreads, time_ns);
    const std::vector<double> deviations = take(*landmark_spreads, time_ns);
    for (size_t i = 0; i + 2 < deviations.size(); i += 3) {
      step.landmark_spread.emplace_back(deviations[i], deviations[i + 1], deviations[i + 2]);
    }
    step.visual_accuracy = take(*accuracies, time_ns);
    step.effective_sample_size = take(*sizes, time_ns);
    for (const auto& [camera, values] : *trust) {
      const auto found = values.find(time_ns);
      step.trust.push_back(found == values.end() ? std::numeric_limits<double>::quiet_NaN() : found->second);
    }
    recording.steps.push_back(std::move(step));
  }
  return recording;
}

}  // namespace silpose
