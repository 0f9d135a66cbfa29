#include "apps/silpose/track_options.h"

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

#include "apps/silpose/body_choice.h"
#include "apps/silpose/command.h"
#include "silpose/exchange/tables.h"
#include "silpose/render/body_levels.h"

namespace silpose::app {
namespace {

constexpr const char* kFitted = "Fitted hypotheses (presets default and accurate)";
constexpr const char* kSampling = "Sampling filters (preset thesis, or with --particles or --layers)";

void add_fitted_options(CLI::App& app, TrackOptions& options) {
  TrackerOptions& tracker = options.tracker;
  app.add_option("--hypotheses", tracker.num_hypotheses, "Hypotheses (possible poses) kept at a time (4; accurate: 8)")
      ->check(CLI::Range(1, 64))
      ->group(kFitted);
  app.add_flag_function(
         "--smooth,!--no-smooth", [&tracker](int64_t count) { tracker.smooth = count > 0; },
         "Of a recorded clip: track both ways, then fit all frames at once (accurate: on)")
      ->group(kFitted);
  app.add_flag_function(
         "--fit-body,!--no-fit-body", [&options](int64_t count) { options.fit_body = count > 0; },
         "Of a recorded clip: track it, fit the body to the subject, track it again. Bones and girths with several "
         "cameras, or with one and --segmenter learned; with one and --floor the size (accurate: on where bones are)")
      ->group(kFitted);
  app.add_flag_function(
         "--floor,!--no-floor", [&tracker](int64_t count) { tracker.floor = count > 0; },
         "The floor is y = 0: nothing lies below; with smoothing, what rests on it does not slide (on with --camera)")
      ->group(kFitted);
}

void add_sampling_options(CLI::App& app, TrackOptions& options) {
  TrackerOptions& tracker = options.tracker;
  const auto add = [&app](const char* name, auto& value, const char* what) {
    return app.add_option(name, value, what)->group(kSampling);
  };
  add("--particles", tracker.num_particles, "Particles in a layer")->check(CLI::Range(2, 1'000'000));
  add("--layers", tracker.num_layers, "Annealing layers; 1 is a plain filter")->check(CLI::Range(1, 200));
  add("--motion", tracker.motion, "How particles move between frames")
      ->check(CLI::IsMember({"diffusion", "first-order-augmented"}));
  add("--sigma-deg", tracker.sigma_deg, "Noise of a typical joint angle in 1/30 s")->check(within(1e-3, 90));
  add("--resampling", tracker.resampling, "Which particles survive")->check(CLI::IsMember({"systematic", "comb"}));
  add("--resample-below", options.resample_below, "Only when n_eff is below this fraction of the particles (1)")
      ->check(within(0, 1));
  add("--regenerate", tracker.regenerate, "Fraction of the particles that the comb regenerates")
      ->check(within(0, 0.99));
  add("--regenerate-from", tracker.regenerate_from,
      "Where regenerated particles come from: random (about the estimate) or network (about the poses it recognises)")
      ->check(CLI::IsMember({"random", "network"}));
  add("--sharpness", tracker.sharpness, "How strongly better silhouettes are preferred")->check(within(1e-3, 1e6));
  add("--metric", tracker.metric,
      "How silhouettes are compared: pixel-count (pixels that differ) or coverage (how much of each; finer, slower)")
      ->check(CLI::IsMember({"pixel-count", "coverage"}));
  add("--root", options.root, "tracked, or fixed where it starts")
      ->capture_default_str()
      ->check(CLI::IsMember({"tracked", "fixed"}));
  add("--estimate", options.estimate, "Which pose is reported: mean, mode or cluster")
      ->check(CLI::IsMember({"mean", "mode", "cluster"}));
}

// The first option given that only the sampling filters have.
std::optional<std::string> sampling_option(const TrackOptions& options) {
  const TrackerOptions& tracker = options.tracker;
  const std::pair<const char*, bool> given[] = {
      {"--motion", tracker.motion.has_value()},         {"--sigma-deg", tracker.sigma_deg.has_value()},
      {"--resampling", tracker.resampling.has_value()}, {"--resample-below", options.resample_below.has_value()},
      {"--regenerate", tracker.regenerate.has_value()}, {"--regenerate-from", tracker.regenerate_from.has_value()},
      {"--sharpness", tracker.sharpness.has_value()},   {"--metric", tracker.metric.has_value()},
      {"--root fixed", options.root == "fixed"},        {"--estimate", options.estimate.has_value()}};
  for (const auto& [name, is_given] : given) {
    if (is_given) return name;
  }
  return std::nullopt;
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
         "--preset", options.tracker.preset,
         "default: hypotheses fitted online; accurate: more of them, the whole mesh, smoothed; thesis: two plain "
         "particle filters, root and pose")
      ->capture_default_str()
      ->check(CLI::IsMember({"default", "accurate", "thesis"}));
  app.add_option("--vertices", options.tracker.lod_vertices,
                 "About how many of the body's are compared (2500; sampling 2000; accurate and 0: all, where passes "
                 "before the smoothing "
                 "take 2500)")
      ->check(CLI::Range(0, 1'000'000));
  app.add_option("--iou", options.level_iou,
                 "Compare the coarsest of the body's levels of detail whose silhouettes share this much with the whole "
                 "body's, on average, in place of --vertices")
      ->check(CLI::Range(0.0, 1.0))
      ->excludes("--vertices");
  app.add_option("--init", options.init,
                 "First pose: descent; landmarks (the same, and it agrees with those that --segmenter learned finds); "
                 "auto (landmarks where some are found); or a poses.csv (its row of the first frame)")
      ->capture_default_str();
  app.add_option(
         "--evidence", options.evidence,
         "What poses are compared by: silhouette; landmarks, the body's keypoints that --segmenter learned finds; "
         "or both, where there are some")
      ->capture_default_str()
      ->check(CLI::IsMember({"silhouette", "landmarks", "both"}));
  app.add_flag("--draw-floor", options.draw_floor,
               "Draw the floor y = 0 (1 m squares) and the footprints into the overlay: do camera and feet fit it?");
  app.add_option("--config", options.config, "Options from a TOML file; the command line wins");
  add_fitted_options(app, options);
  add_sampling_options(app, options);
}

void check_together(const TrackOptions& options) {
  for (const std::string& video : options.input.videos) {
    if (options.resume && video.starts_with("camera:")) {
      throw UsageError(fmt::format("--resume: {} is live; give a recorded clip", video));
    }
  }
  const TrackerOptions& tracker = options.tracker;
  const char* const sampler = tracker.num_particles ? "--particles"
                              : tracker.num_layers  ? "--layers"
                                                    : "--preset thesis";
  if (tracker.preset == "thesis" || tracker.num_particles || tracker.num_layers) {
    if (tracker.num_hypotheses) throw UsageError(fmt::format("--hypotheses: not together with {}", sampler));
    if (options.fit_body.value_or(false)) throw UsageError(fmt::format("--fit-body: not together with {}", sampler));
    if (tracker.smooth.value_or(false)) throw UsageError(fmt::format("--smooth: not together with {}", sampler));
    if (tracker.floor.value_or(false)) throw UsageError(fmt::format("--floor: not together with {}", sampler));
    return;
  }
  if (const std::optional<std::string> name = sampling_option(options)) {
    throw UsageError(fmt::format("{}: needs --particles, --layers or --preset thesis", *name));
  }
  if (options.fit_body.value_or(false)) {
    if (options.evidence == "landmarks") throw UsageError("--fit-body: not together with --evidence landmarks");
  }
  for (const std::string& video : options.input.videos) {
    if (video.starts_with("camera:") && *tracker.resolved().smooth) {
      throw UsageError(fmt::format("--smooth: {} is live, smoothing needs a recorded clip{}", video,
                                   tracker.smooth ? "" : " (--preset accurate smooths; --no-smooth)"));
    }
    if (video.starts_with("camera:") && options.fit_body.value_or(false)) {
      throw UsageError(fmt::format("--fit-body: {} is live, a body is fitted to a recorded clip", video));
    }
  }
}

bool fits_body(const TrackOptions& options, bool finds_keypoints) {
  const bool one_camera = options.each || options.input.videos.size() == 1;
  const bool bones_determined =
      options.evidence != "landmarks" && (!one_camera || (options.evidence == "both" && finds_keypoints));
  if (options.fit_body.value_or(false) && !bones_determined && !options.camera.has_file()) {
    throw UsageError(
        "--fit-body: with one camera, bones need keypoints, which --segmenter learned finds, and the size needs a "
        "floor, which --camera gives");
  }
  const TrackerOptions resolved = options.tracker.resolved();
  return options.fit_body.value_or(options.tracker.preset == "accurate" && resolved.num_hypotheses &&
                                   *resolved.smooth && bones_determined);
}

bool estimates_camera(const TrackOptions& options) {
  return options.camera.file.empty() && options.input.videos.size() == 1 &&
         !options.input.videos[0].starts_with("camera:");
}

Result<TrackerOptions> tracker_options(const TrackOptions& options, std::shared_ptr<const BodyModel> body,
                                       std::vector<PinholeCamera> cameras, uint64_t seed) {
  TrackerOptions tracker = options.tracker;
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
  if (!tracker.floor && !options.camera.has_file()) tracker.floor = false;
  tracker.evidence = options.evidence == "silhouette"  ? EvidenceKind::kSilhouette
                     : options.evidence == "landmarks" ? EvidenceKind::kKeypoints
                                                       : EvidenceKind::kBoth;
  tracker.root_fixed = options.root == "fixed";
  tracker.resample_below = options.resample_below.value_or(tracker.resample_below);
  if (options.estimate == "mean") tracker.estimate = Estimate::kMean;
  if (options.estimate == "mode") tracker.estimate = Estimate::kMode;
  if (options.estimate == "cluster") tracker.estimate = Estimate::kCluster;
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
  const auto keep = [&](const char* name, const auto& value) {
    if (value) chosen[name] = fmt::format("{}", *value);
  };
  keep("vertices", used.lod_vertices);
  keep("hypotheses", used.num_hypotheses);
  if (used.num_hypotheses) {
    keep("smooth", used.smooth);
    keep("fit-body", options.fit_body);
    keep("floor", used.floor);
    return chosen;
  }
  keep("particles", used.num_particles);
  keep("layers", used.num_layers);
  keep("motion", used.motion);
  keep("sigma-deg", used.sigma_deg);
  keep("resampling", used.resampling);
  keep("resample-below", std::optional(used.resample_below));
  keep("regenerate", used.regenerate);
  keep("regenerate-from", used.regenerate_from);
  keep("metric", used.metric);
  keep("sharpness", used.sharpness);
  if (used.estimate) {
    chosen["estimate"] = *used.estimate == Estimate::kMean   ? "mean"
                         : *used.estimate == Estimate::kMode ? "mode"
                                                             : "cluster";
  }
  return chosen;
}

}  // namespace silpose::app
