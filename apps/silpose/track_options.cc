#include "apps/silpose/track_options.h"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

#include "apps/silpose/body_choice.h"
#include "apps/silpose/command.h"
#include "apps/silpose/table_options.h"
#include "silpose/exchange/tables.h"
#include "silpose/render/body_levels.h"
#include "silpose/track/tracker_presets.h"

namespace silpose::app {
namespace {

void add_fit_body_option(CLI::App& app, TrackOptions& options) {
  app.add_flag_function(
         "--fit-body,!--no-fit-body", [&options](int64_t count) { options.fit_body = count > 0; },
         "Of a recorded clip: track it, fit the body to the subject, track it again. Bones and girths with several "
         "cameras, or with one and --segmenter learned; with one and --floor the size (accurate: on where bones are)")
      ->group(fitted_option_table().group);
}

// Beside the number of vertices: how else it can be chosen, and the first pose.
void add_level_and_start_options(CLI::App& app, TrackOptions& options) {
  app.add_option("--iou", options.level_iou,
                 "Compare the coarsest of the body's levels of detail whose silhouettes share this much with the whole "
                 "body's, on average, in place of --vertices")
      ->check(CLI::Range(0.0, 1.0))
      ->excludes("--vertices");
  app.add_option("--init", options.init,
                 "First pose: descent; landmarks (the same, and it agrees with those that --segmenter learned finds); "
                 "auto (landmarks where some are found); or a poses.csv (its row of the first frame)")
      ->capture_default_str();
}

std::vector<std::string> preset_words() {
  const std::vector<std::string_view> names = preset_names();
  return {names.begin(), names.end()};
}

// The option that asks for a sampling filter.
const char* sampler_of(const TrackOptions& options) {
  return options.tracker.contains("particles") ? "--particles"
         : options.tracker.contains("layers")  ? "--layers"
                                               : "--preset thesis";
}

}  // namespace

void add_track_options(CLI::App& app, TrackOptions& options) {
  add_input_options(app, options.input);
  app.add_option("--out", options.out, "Directory for the result");
  app.add_flag("--each", options.each, "Every VIDEO is a separate clip, its result in DIR/NAME");
  app.add_flag("--resume", options.resume,
               "Resume from what the same command, interrupted, left in DIR.partial; with --each, leave out clips that "
               "have a result already");
  add_model_option(app, options.model);
  add_camera_options(app, options.camera);
  add_focal_options(app, options.camera);
  app.add_option(
         "--preset", options.preset,
         "default: hypotheses fitted online; accurate: more of them, the whole mesh, smoothed; thesis: two plain "
         "particle filters, root and pose")
      ->capture_default_str()
      ->check(CLI::IsMember(preset_words()));
  add_table_options(app, tracker_option_table(), "Options", defaults_text,
                    {{"vertices", [&] { add_level_and_start_options(app, options); }}}, options.tracker);
  app.add_flag("--draw-floor", options.draw_floor,
               "Draw the floor y = 0 (1 m squares) and the footprints into the overlay: do camera and feet fit it?");
  app.add_option("--config", options.config, "Options from a TOML file; the command line wins");
  add_table_options(app, fitted_option_table(), fitted_option_table().group, defaults_text,
                    {{"smooth", [&] { add_fit_body_option(app, options); }}}, options.tracker);
  add_table_options(app, sampling_option_table(), sampling_option_table().group, defaults_text, {}, options.tracker);
}

void check_together(const TrackOptions& options) {
  for (const std::string& video : options.input.videos) {
    if (options.resume && video.starts_with("camera:")) {
      throw UsageError(fmt::format("--resume: {} is live; give a recorded clip", video));
    }
  }
  if (const auto refused = refused_option(options.preset, options.tracker, "--")) {
    throw UsageError(fmt::format("--{}: {}", refused->name, refused->why));
  }
  const TrackerOptions tracker = make_tracker_options(options.preset, options.tracker);
  const bool fits_body = options.fit_body.value_or(false);
  if (tracker.sampling() != nullptr) {
    if (fits_body) throw UsageError(fmt::format("--fit-body: not together with {}", sampler_of(options)));
    return;
  }
  if (fits_body && tracker.evidence == EvidenceKind::kKeypoints) {
    throw UsageError("--fit-body: not together with --evidence landmarks");
  }
  for (const std::string& video : options.input.videos) {
    if (video.starts_with("camera:") && tracker.smooths()) {
      throw UsageError(
          fmt::format("--smooth: {} is live, smoothing needs a recorded clip{}", video,
                      options.tracker.contains("smooth") ? "" : " (--preset accurate smooths; --no-smooth)"));
    }
    if (video.starts_with("camera:") && fits_body) {
      throw UsageError(fmt::format("--fit-body: {} is live, a body is fitted to a recorded clip", video));
    }
  }
}

bool fits_body(const TrackOptions& options, bool finds_keypoints) {
  const bool one_camera = options.each || options.input.videos.size() == 1;
  const TrackerOptions tracker = make_tracker_options(options.preset, options.tracker);
  const bool bones_determined = tracker.evidence != EvidenceKind::kKeypoints &&
                                (!one_camera || (tracker.evidence == EvidenceKind::kBoth && finds_keypoints));
  if (options.fit_body.value_or(false) && !bones_determined && !options.camera.has_file()) {
    throw UsageError(
        "--fit-body: with one camera, bones need keypoints, which --segmenter learned finds, and the size needs a "
        "floor, which --camera gives");
  }
  return options.fit_body.value_or(options.preset == "accurate" && tracker.smooths() && bones_determined);
}

bool estimates_camera(const TrackOptions& options) {
  return options.camera.file.empty() && options.input.videos.size() == 1 &&
         !options.input.videos[0].starts_with("camera:");
}

Result<TrackerOptions> tracker_options(const TrackOptions& options, std::shared_ptr<const BodyModel> body,
                                       std::vector<PinholeCamera> cameras, uint64_t seed) {
  TrackerOptions tracker = make_tracker_options(options.preset, options.tracker);
  if (options.level_iou) {
    const Result<const BodyLevel*> level = choose_level(*body, *options.level_iou);
    if (!level) return level.failure();
    tracker.lod_vertices = (*level)->asked_vertices;
  }
  tracker.body = std::move(body);
  tracker.cameras = std::move(cameras);
  tracker.seed = seed;
  tracker.size_deviation = size_deviation_of(options.model);
  // Without a file the floor is a guess: even where the camera was estimated, poses constrained to it were worse.
  if (tracker.fitted() != nullptr && !options.tracker.contains("floor") && !options.camera.has_file()) {
    tracker.fitted()->floor = false;
  }
  try {
    tracker.check();
  } catch (const std::invalid_argument& wrong) {
    throw UsageError(wrong.what());
  }
  return tracker;
}

Result<std::optional<std::vector<double>>> read_initial_pose(const TrackOptions& options, const Skeleton& skeleton,
                                                             int64_t frame) {
  const std::string& init = options.init;
  if (init == "auto" || init == "descent" || init == "landmarks") return std::optional<std::vector<double>>();
  const Result<PoseTable> table = read_poses(options.init, skeleton);
  if (!table) return table.failure();
  if (table->rows.empty()) return error("{}: no pose in it", options.init);
  for (const PoseTable::Row& row : table->rows) {
    if (row.frame == frame) return std::optional(row.values);
  }
  return std::optional(table->rows.front().values);
}

std::map<std::string, std::string> chosen_options(const TrackOptions& options, const TrackerOptions& used) {
  std::map<std::string, std::string> chosen;
  if (options.each) chosen["video"] = options.input.videos.front();
  for (const auto& [name, value] : named_options(used)) chosen[name] = text_of(value);
  if (used.fitted() != nullptr && options.fit_body) chosen["fit-body"] = text_of(*options.fit_body);
  return chosen;
}

}  // namespace silpose::app
