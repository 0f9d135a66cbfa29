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
  const Result<int64_t> count = board.count(path);
  if (!count) return count.failure();
  if (*count == 0) return values;
  auto entries = sadb::read_range(board, path);
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
  const auto infos = board.list(folder);
  if (!infos) return infos.failure();
  for (const sadb::PathInfo& info : *infos) {
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

sadb::Schema pose_schema(const Skeleton& skeleton) {
  using Kind = sadb::PoseDof::Kind;
  sadb::PoseSchema pose{skeleton.name(), {}};
  for (const Dof& dof : skeleton.dofs()) {
    pose.dofs.push_back({.name = dof.name,
                         .kind = dof.is_shape         ? Kind::kShape
                                 : dof.is_translation ? Kind::kTranslation
                                                      : Kind::kRotation,
                         .unit = dof.is_translation ? "m" : "rad",
                         .period = dof.is_periodic ? 2 * kPi : 0});
  }
  return {sadb::Type::kPose, std::move(pose)};
}

TrackRecorder::TrackRecorder(std::shared_ptr<sadb::Blackboard> board, const Skeleton& skeleton,
                             std::vector<std::string> camera_names, RecorderOptions options)
    : board_(std::move(board)),
      pose_(pose_schema(skeleton)),
      camera_names_(std::move(camera_names)),
      options_(std::move(options)) {
  check(board_ != nullptr, "TrackRecorder: no board");
}

Result<void> TrackRecorder::put(const StepReport& report) {
  const auto path = [&](const std::string& name) { return options_.prefix + "/" + name; };
  check(report.trust.size() <= camera_names_.size() && report.observed.size() <= camera_names_.size(),
        "TrackRecorder: {} cameras in a report, {} names", report.trust.size(), camera_names_.size());
  if (!is_declared_) {
    for (const char* name : {"pose", "mode"}) {
      if (Result<void> declared = board_->declare(path(name), pose_); !declared) return declared;
    }
    is_declared_ = true;
  }
  std::vector<sadb::PathEntry> step;
  const auto add = [&](const std::string& name, sadb::Value value) {
    step.push_back({path(name), report.time_ns, std::move(value)});
  };
  add("frame", static_cast<double>(report.frame_idx));
  add("state", std::string(state_name(report.state)));
  add("visual_accuracy", report.visual_accuracy);
  add("effective_sample_size", report.effective_sample_size);
  if (!report.pose.empty()) {
    add("pose", sadb::Pose{pose_.pose->skeleton, report.pose});
    add("mode", sadb::Pose{pose_.pose->skeleton, report.mode});
    add("spread", report.spread);
    add("landmark_spread", flattened(report.landmark_spread));
  }
  for (size_t c = 0; c < report.trust.size(); ++c) add("trust/" + camera_names_[c], report.trust[c].overall);
  for (size_t c = 0; options_.masks && c < report.observed.size(); ++c) {
    add("observed/" + camera_names_[c], report.observed[c]);
  }
  return board_->put_batch(std::move(step));
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
