#include "silpose/experiment/tracking_runs.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "silpose/base/clock.h"
#include "silpose/base/parallel.h"
#include "silpose/experiment/score_clip.h"
#include "silpose/experiment/score_run.h"
#include "silpose/offline/body_fit.h"
#include "silpose/offline/track_clip.h"
#include "silpose/synth/degraded_mask.h"
#include "silpose/synth/drawn_person.h"
#include "silpose/synth/simulated_keypoints.h"
#include "silpose/track/tracker_presets.h"

namespace silpose {
namespace {

// The one place that turns settings into options of the tracker. Errors: an option that it does not have.
Result<TrackerOptions> choose_tracker(const RunSettings& settings, std::shared_ptr<const BodyModel> body,
                                      std::vector<PinholeCamera> cameras, uint64_t seed) {
  try {
    TrackerOptions options = make_tracker_options(settings.preset, settings.tracker);
    options.body = std::move(body);
    options.cameras = std::move(cameras);
    options.seed = seed;
    const bool learned = settings.is_recorded() && settings.segmenter == "learned";
    options.landmarks = settings.keypoints || learned;  // as `silpose track` starts
    options.check();
    return options;
  } catch (const std::invalid_argument& wrong) {
    return error("the tracker refuses its options: {}", wrong.what());
  }
}

// The model of a person some percent taller or heavier than `body`.
std::string model_beside(const std::string& model, const BodyModel& body, const RunSettings& settings) {
  if (settings.body_height == 1 && settings.body_weight == 1) return model;
  std::string person;  // the model's own keys, without stature and mass
  const size_t colon = model.find(':');
  for (size_t at = colon; at != std::string::npos && at + 1 < model.size();) {
    const size_t comma = model.find(',', at + 1);
    const std::string entry = model.substr(at + 1, comma == std::string::npos ? comma : comma - at - 1);
    if (!entry.starts_with("height=") && !entry.starts_with("weight=")) person += entry + ",";
    at = comma;
  }
  return fmt::format("{}:{}height={:.4f},weight={:.2f}", model.substr(0, colon), person,
                     body.height_m * settings.body_height, body.weight_kg * settings.body_weight);
}

// A dof: motion swings over `range` (metres or degrees) in place of the DOF's limits.
Result<void> use_range(const RunSettings& settings, const BodyModel& body, SyntheticMotion& motion) {
  if (!settings.motion.starts_with("dof:")) {
    return error("range: only for the motion dof:INDEX, not {}", settings.motion);
  }
  const auto index = static_cast<size_t>(std::stoul(settings.motion.substr(4)));  // make_motion took it
  const Dof& dof = body.skeleton.dofs()[index];
  const double scale = dof.is_translation ? 1 : to_radians(1);
  const double lower = (*settings.range)[0] * scale, upper = (*settings.range)[1] * scale;
  for (std::vector<double>& pose : motion.poses) {
    pose[index] = lower + (upper - lower) * (pose[index] - dof.lower) / (dof.upper - dof.lower);
  }
  return {};
}

Result<SyntheticSequence> sequence_of(const RunSettings& settings, uint64_t seed, const std::filesystem::path& data,
                                      const std::shared_ptr<const BodyModel>& body,
                                      std::optional<double>& residual_deg) {
  SceneOptions scene{.width = settings.width,
                     .height = settings.height,
                     .focal_px = settings.focal_px,
                     .distance_m = settings.distance_m,
                     .views = {}};
  for (const std::string& text : settings.views) {
    const Result<View> view = parse_view(text);
    if (!view) return error("view {}: {}", text, view.error().message);
    scene.views.push_back(*view);
  }
  if (scene.views.empty()) return error("views: at least one is wanted");
  const bool is_file = is_motion_file(settings.motion);
  Result<SyntheticMotion> motion = make_motion(is_file ? (data / settings.motion).string() : settings.motion, *body,
                                               {.num_frames = settings.frames,
                                                .fps = settings.fps,
                                                .amplitude_deg = settings.amplitude_deg,
                                                .period_s = settings.period_s,
                                                .seed = seed});
  if (!motion) return motion.failure();
  residual_deg = motion->mean_residual_deg;
  if (settings.range) {
    const Result<void> used = use_range(settings, *body, *motion);
    if (!used) return used.failure();
  }
  return make_sequence(body, *motion, scene);
}

// The masks of one camera [T], true or degraded.
Result<std::vector<Mask>> masks_of(const SyntheticSequence& sequence, int camera_idx, const RunSettings& settings,
                                   uint64_t seed) {
  const Result<MaskFault> fault = parse_mask_fault(settings.mask_noise);
  if (!fault) return error("mask_noise: {}", fault.error().message);
  if (*fault != MaskFault::kNone) {
    return degraded_masks(sequence, camera_idx,
                          {.fault = *fault, .iou = settings.mask_iou, .outline = {}, .seed = seed});
  }
  std::vector<Mask> masks(static_cast<size_t>(sequence.num_frames()));
  parallel_for(masks.size(), 1, [&](size_t begin, size_t end) {
    for (size_t t = begin; t < end; ++t) masks[t] = true_mask(sequence, camera_idx, static_cast<int>(t));
  });
  return masks;
}

// What a segmenter would hand over.
Observation observation_of(Mask mask) {
  Observation observation{std::move(mask)};
  const Box box = observation.box();
  const auto& [x, y, width, height] = box;
  observation.trust.nothing_found = box.empty();
  observation.trust.overall = box.empty() ? 0 : 1;
  observation.trust.touches_border = !box.empty() && (x == 0 || y == 0 || x + width == observation.mask.width() ||
                                                      y + height == observation.mask.height());
  return observation;
}

// The pixels in which a mask is wrong, and those within 2 pixels of them.
Mask faults_of(const Mask& mask, const Mask& truth) {
  constexpr int kReach = 2;
  Mask faults(mask.width(), mask.height());
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      if (mask.get(x, y) == truth.get(x, y)) continue;
      for (int v = std::max(y - kReach, 0); v <= std::min(y + kReach, mask.height() - 1); ++v) {
        for (int u = std::max(x - kReach, 0); u <= std::min(x + kReach, mask.width() - 1); ++u) faults.set(u, v);
      }
    }
  }
  return faults;
}

// Makes the body the subject's, as far as the instants determine it.
void fit_subject(TrackerOptions& options, std::span<const ClipInstant> instants, const ClipProgress& progress) {
  std::vector<std::vector<double>> poses;
  for (const StepReport& report : track_clip(options_before_fit(options), instants, progress)) {
    poses.push_back(report.pose);
  }
  if (poses.size() != instants.size()) return;  // stopped
  const std::optional<BodyFit> fit = fit_body(options, instants, poses, [&] { return progress(0, instants.size()); });
  if (fit) options = options_after_fit(std::move(options), *fit);
}

// Tracks the instants, with a body fitted to the subject where that is asked for; nothing when `go_on` says false.
// Scores of the tracker's times, without those of the fit, are added to those that `score` makes of its reports.
Result<std::optional<RunResult>> track_and_score(
    TrackerOptions options, bool fit_body_first, std::span<const ClipInstant> instants,
    const std::function<bool()>& go_on,
    const std::function<Result<RunResult>(const BodyModel&, std::span<const StepReport>)>& score) {
  bool stopped = false;
  const auto progress = [&](size_t, size_t) {
    stopped = stopped || !go_on();
    return !stopped;
  };
  if (fit_body_first) fit_subject(options, instants, progress);
  if (stopped) return std::optional<RunResult>();
  const Stopwatch tracking;
  const std::vector<StepReport> reports = track_clip(options, instants, progress);
  const double tracking_s = tracking.seconds();
  if (stopped) return std::optional<RunResult>();
  Result<RunResult> result = score(*options.body, reports);
  if (!result) return result.failure();
  double start_s = 0;
  for (const StepReport& report : reports) start_s += report.seconds.start;
  const auto num_frames = static_cast<double>(reports.size());
  result->scores["frames_per_second"] = num_frames / std::max(tracking_s - start_s, 1e-9);
  result->scores["frames_per_second_with_start"] = num_frames / std::max(tracking_s, 1e-9);
  result->scores["start_s"] = start_s;
  return std::optional<RunResult>(std::move(*result));
}

double mean_overlap(const SyntheticSequence& sequence, const std::vector<ClipInstant>& instants) {
  std::vector<double> overlap(instants.size());
  parallel_for(instants.size(), 1, [&](size_t begin, size_t end) {
    for (size_t t = begin; t < end; ++t) {
      overlap[t] =
          intersection_over_union(instants[t].observations[0].mask, true_mask(sequence, 0, static_cast<int>(t)));
    }
  });
  double sum = 0;
  for (const double value : overlap) sum += value;
  return sum / static_cast<double>(overlap.size());
}

}  // namespace

Result<std::shared_ptr<const BodyModel>> TrackingRuns::body(const std::string& model) {
  const auto kept = kept_bodies_.find(model);
  if (kept != kept_bodies_.end()) return kept->second;
  Result<std::shared_ptr<const BodyModel>> made = bodies_(model);
  if (made) kept_bodies_.emplace(model, *made);
  return made;
}

Result<const TrackingRuns::Seen*> TrackingRuns::see(const RunSettings& settings, uint64_t seed) {
  const bool is_drawn = settings.motion == "static" || settings.motion == "random" || settings.mask_noise != "none" ||
                        settings.drawn_person || settings.keypoints;
  const std::string key = fmt::format("{} {}", sequence_text(settings), is_drawn ? seed : 0);
  if (seen_ && seen_->key == key) return &*seen_;

  seen_.reset();
  const auto true_body = body(settings.model);
  if (!true_body) return true_body.failure();
  Seen seen;
  seen.key = key;
  std::shared_ptr<const BodyModel> subject = *true_body;
  if (settings.drawn_person) subject = std::make_shared<const BodyModel>(draw_person(*subject, seed));
  Result<SyntheticSequence> sequence = sequence_of(settings, seed, data_, subject, seen.residual_deg);
  if (!sequence) return sequence.failure();
  seen.sequence = std::move(*sequence);
  seen.instants.resize(static_cast<size_t>(seen.sequence.num_frames()));
  for (size_t t = 0; t < seen.instants.size(); ++t) {
    seen.instants[t].frame_idx = static_cast<int64_t>(t);
    seen.instants[t].time_ns = std::llround(static_cast<double>(t) * 1e9 / seen.sequence.fps);
  }
  for (size_t c = 0; c < seen.sequence.cameras.size(); ++c) {
    Result<std::vector<Mask>> masks = masks_of(seen.sequence, static_cast<int>(c), settings, seed);
    if (!masks) return masks.failure();
    std::optional<SimulatedKeypoints> network;
    try {
      if (settings.keypoints) network.emplace(seen.sequence, static_cast<int>(c), seed);
    } catch (const std::invalid_argument& wrong) {
      return error("keypoints: model {}: {}", settings.model, wrong.what());
    }
    for (size_t t = 0; t < masks->size(); ++t) {
      Observation observation = observation_of(std::move((*masks)[t]));
      if (network && !observation.trust.nothing_found) {
        SimulatedKeypoints::Seen drawn = network->draw(static_cast<int>(t), observation.box());
        observation.keypoints_2d = std::move(drawn.keypoints_2d);
        observation.keypoints_3d = std::move(drawn.keypoints_3d);
      }
      if (settings.faults_known && settings.mask_noise != "none") {
        const Mask truth = true_mask(seen.sequence, static_cast<int>(c), static_cast<int>(t));
        observation.ignored = std::make_shared<const Mask>(faults_of(observation.mask, truth));
      }
      seen.instants[t].observations.push_back(std::move(observation));
    }
  }
  if (settings.mask_noise != "none") seen.mask_iou = mean_overlap(seen.sequence, seen.instants);
  seen_ = std::move(seen);
  return &*seen_;
}

Result<std::optional<RunResult>> TrackingRuns::run(const RunSettings& settings, uint64_t seed,
                                                   const std::function<bool()>& go_on) {
  switch (settings.run_kind()) {
    case RunKind::kTrack:
      return track_sequence(settings, seed, go_on);
    case RunKind::kTrackClip:
    case RunKind::kKeypoints:
      return run_recorded(settings, seed, go_on);
  }
  return error("no such kind of run");
}

Result<std::optional<RunResult>> TrackingRuns::track_sequence(const RunSettings& settings, uint64_t seed,
                                                              const std::function<bool()>& go_on) {
  const Stopwatch all;
  const auto seen = see(settings, seed);
  if (!seen) return seen.failure();
  const SyntheticSequence& sequence = (*seen)->sequence;
  const auto given_body = body(settings.model);
  if (!given_body) return given_body.failure();
  const auto tracker_body = body(model_beside(settings.model, **given_body, settings));
  if (!tracker_body) return tracker_body.failure();

  Result<TrackerOptions> options = choose_tracker(settings, *tracker_body, sequence.cameras, seed);
  if (!options) return options.failure();
  if (settings.start == "truth") options->initial_pose = sequence.poses[0];
  if (!go_on()) return std::optional<RunResult>();
  auto result = track_and_score(*std::move(options), settings.fit_body, (*seen)->instants, go_on,
                                [&](const BodyModel& tracked_body, std::span<const StepReport> reports) {
                                  return score_run(sequence, tracked_body, reports);
                                });
  if (!result || !result->has_value()) return result;
  RunResult& run = **result;
  run.scores["mask_iou"] = (*seen)->mask_iou;
  if ((*seen)->residual_deg) run.scores["retargeting_residual_deg"] = *(*seen)->residual_deg;
  run.wall_s = all.seconds();
  return result;
}

Result<std::optional<TrackingRuns::RecordedClip>> TrackingRuns::read_clip(const RunSettings& settings,
                                                                          const std::function<bool()>& go_on) {
  RecordedClip clip;
  const auto clip_body = body(settings.model);
  if (!clip_body) return clip_body.failure();
  clip.body = *clip_body;
  Result<std::vector<PinholeCamera>> cameras = read_clip_cameras(settings, data_);
  if (!cameras) return cameras.failure();
  clip.cameras = *std::move(cameras);
  Result<ClipTruth> truth = read_clip_truth(settings, data_, *clip.body);
  if (!truth) return truth.failure();
  clip.truth = *std::move(truth);

  ClipInput input{.videos = {}, .segmenter = settings.segmenter, .backgrounds = {}, .num_frames = settings.frames};
  for (const std::string& video : settings.clip) input.videos.push_back((data_ / video).string());
  for (const std::string& background : settings.background) {
    input.backgrounds.push_back(background == "auto" ? background : (data_ / background).string());
  }
  auto instants = clips_.read(input, go_on);
  if (!instants) return instants.failure();
  if (!instants->has_value()) return std::optional<RecordedClip>();
  clip.instants = **std::move(instants);
  for (size_t c = 0; c < clip.cameras.size(); ++c) {
    const PinholeCamera& camera = clip.cameras[c];
    const Mask& mask = clip.instants[0].observations[c].mask;
    if (mask.width() == camera.width && mask.height() == camera.height) continue;
    return error("{}: camera {} is calibrated for {}x{}, the video is {}x{}", settings.camera, camera.name,
                 camera.width, camera.height, mask.width(), mask.height());
  }
  return std::optional(std::move(clip));
}

Result<std::optional<RunResult>> TrackingRuns::run_recorded(const RunSettings& settings, uint64_t seed,
                                                            const std::function<bool()>& go_on) {
  const Stopwatch all;
  const auto clip = read_clip(settings, go_on);
  if (!clip) return clip.failure();
  if (!clip->has_value()) return std::optional<RunResult>();
  const RecordedClip& recorded = **clip;
  auto result = settings.run_kind() == RunKind::kKeypoints ? score_network(recorded)
                                                           : track_recorded(settings, recorded, seed, go_on);
  if (result && result->has_value()) (*result)->wall_s = all.seconds();
  return result;
}

Result<std::optional<RunResult>> TrackingRuns::track_recorded(const RunSettings& settings, const RecordedClip& recorded,
                                                              uint64_t seed, const std::function<bool()>& go_on) {
  Result<TrackerOptions> options = choose_tracker(settings, recorded.body, recorded.cameras, seed);
  if (!options) return options.failure();
  return track_and_score(*std::move(options), settings.fit_body, recorded.instants, go_on,
                         [&](const BodyModel& tracked_body, std::span<const StepReport> reports) {
                           return score_clip(recorded.truth, tracked_body, recorded.cameras, reports);
                         });
}

Result<std::optional<RunResult>> TrackingRuns::score_network(const RecordedClip& recorded) {
  Result<RunResult> scored = score_keypoints(recorded.truth, *recorded.body, recorded.cameras[0], recorded.instants);
  if (!scored) return scored.failure();
  return std::optional<RunResult>(*std::move(scored));
}

}  // namespace silpose
