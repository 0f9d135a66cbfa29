#include "silpose/session/track_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "silpose/base/option_error.h"
#include "silpose/exchange/tables.h"
#include "silpose/render/body_levels.h"
#include "silpose/session/body_choice.h"
#include "silpose/track/tracker_presets.h"

namespace silpose {
namespace {

// The option that asks for a sampling filter.
const char* sampler_of(const TrackOptions& options) {
  return options.tracker.contains("particles") ? "--particles"
         : options.tracker.contains("layers")  ? "--layers"
                                               : "--preset thesis";
}

bool starts_from_file(const std::string& init) { return init != "auto" && init != "descent" && init != "landmarks"; }

}  // namespace

std::string live_input(const std::vector<std::string>& videos) {
  const auto live = std::ranges::find_if(videos, [](const std::string& video) { return video.starts_with("camera:"); });
  return live == videos.end() ? "" : *live;
}

void TrackOptions::check() const {
  input.check();
  if (const auto refused = refused_option(preset, tracker, "--")) {
    throw_option_error("--{}: {}", refused->name, refused->why);
  }
  const TrackerOptions made = make_tracker_options(preset, tracker);
  const bool fits = fit_body.value_or(false);
  if (made.sampling() != nullptr) {
    if (fits) throw_option_error("--fit-body: not together with {}", sampler_of(*this));
    return;
  }
  if (fits && made.evidence == EvidenceKind::kKeypoints) {
    throw_option_error("--fit-body: not together with --evidence landmarks");
  }
  const std::string live = live_input(input.videos);
  if (live.empty()) return;
  if (made.smooths()) {
    throw_option_error("--smooth: {} is live, smoothing needs a recorded clip{}", live,
                       tracker.contains("smooth") ? "" : " (--preset accurate smooths; --no-smooth)");
  }
  if (fits) throw_option_error("--fit-body: {} is live, a body is fitted to a recorded clip", live);
}

bool fits_body(const TrackOptions& options, bool finds_keypoints) {
  const TrackerOptions tracker = make_tracker_options(options.preset, options.tracker);
  const bool several = options.input.videos.size() > 1;
  const bool bones_determined = tracker.evidence != EvidenceKind::kKeypoints &&
                                (several || (tracker.evidence == EvidenceKind::kBoth && finds_keypoints));
  if (options.fit_body.value_or(false) && !bones_determined && !options.camera.has_file()) {
    throw_option_error(
        "--fit-body: with one camera, bones need keypoints, which --segmenter learned finds, and the size needs a "
        "floor, which --camera gives");
  }
  return options.fit_body.value_or(options.preset == "accurate" && tracker.smooths() && bones_determined);
}

bool estimates_camera(const TrackOptions& options) {
  return options.camera.file.empty() && options.input.videos.size() == 1 && live_input(options.input.videos).empty();
}

Result<TrackerOptions> tracker_options(const TrackOptions& options, std::shared_ptr<const BodyModel> body,
                                       std::vector<PinholeCamera> cameras) {
  TrackerOptions tracker = make_tracker_options(options.preset, options.tracker);
  if (options.level_iou) {
    const Result<const BodyLevel*> level = choose_level(*body, *options.level_iou);
    if (!level) return level.failure();
    tracker.lod_vertices = (*level)->asked_vertices;
  }
  tracker.body = std::move(body);
  tracker.cameras = std::move(cameras);
  tracker.seed = options.seed;
  tracker.size_deviation = size_deviation_of(options.model);
  // Without a file the floor is a guess: even where the camera was estimated, poses constrained to it were worse.
  if (tracker.fitted() != nullptr && !options.tracker.contains("floor") && !options.camera.has_file()) {
    tracker.fitted()->floor = false;
  }
  try {
    tracker.check();
  } catch (const std::invalid_argument& wrong) {
    throw OptionError(wrong.what());
  }
  return tracker;
}

Result<void> check_keypoints(const TrackOptions& options, const TrackerOptions& tracker, const std::string& segmenter) {
  const auto refused = [&](const char* option, const char* what) {
    return error("{}: {} finds {}; --segmenter learned does", option, segmenter, what);
  };
  if (options.init == "landmarks") return refused("--init landmarks", "none");
  if (tracker.evidence == EvidenceKind::kKeypoints) return refused("--evidence landmarks", "none");
  const SamplingOptions* const sampling = tracker.sampling();
  if (sampling != nullptr && sampling->regenerate_from == RegenerateFrom::kNetwork) {
    return refused("--regenerate-from network", "no keypoints");
  }
  return {};
}

Result<std::optional<std::vector<double>>> read_initial_pose(const TrackOptions& options, const Skeleton& skeleton,
                                                             int64_t frame) {
  if (!starts_from_file(options.init)) return std::optional<std::vector<double>>();
  const Result<PoseTable> table = read_poses(options.init, skeleton);
  if (!table) return table.failure();
  if (table->rows.empty()) return error("{}: no pose in it", options.init);
  const auto row = std::ranges::find(table->rows, frame, &PoseTable::Row::frame);
  return std::optional(row == table->rows.end() ? table->rows.front().values : row->values);
}

std::map<std::string, std::string> chosen_options(const TrackOptions& options, const TrackerOptions& used) {
  std::map<std::string, std::string> chosen;
  for (const auto& [name, value] : named_options(used)) chosen[name] = text_of(value);
  if (used.fitted() != nullptr && options.fit_body) chosen["fit-body"] = text_of(*options.fit_body);
  return chosen;
}

}  // namespace silpose
