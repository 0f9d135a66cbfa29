// silpose track: from a clip to poses.
#include <fmt/format.h>

#include <memory>
#include <utility>

#include "apps/silpose/body_choice.h"
#include "apps/silpose/clip_camera_choice.h"
#include "apps/silpose/command.h"
#include "apps/silpose/option_file.h"
#include "apps/silpose/run_facts.h"
#include "apps/silpose/track_each.h"
#include "apps/silpose/track_options.h"
#include "apps/silpose/track_result.h"
#include "silpose/base/clock.h"
#include "silpose/evaluate/interval_coverage.h"
#include "silpose/exchange/mot.h"
#include "silpose/session/overlay_file.h"
#include "silpose/session/result_directory.h"
#include "silpose/session/result_files.h"
#include "silpose/session/session.h"
#include "silpose_commit.h"

namespace silpose::app {
namespace {

// Errors: an option that needs keypoints, where the segmenter finds none.
Result<void> check_keypoints(const TrackOptions& options, const TrackerOptions& tracker,
                             const ObservationSource& source) {
  if (source.finds_keypoints()) return {};
  const auto refused = [&](const char* option, const char* what) {
    return error("{}: {} finds {}; --segmenter learned does", option, source.segmentation(), what);
  };
  if (options.init == "landmarks") return refused("--init landmarks", "none");
  if (tracker.evidence == EvidenceKind::kKeypoints) return refused("--evidence landmarks", "none");
  const SamplingOptions* const sampling = tracker.sampling();
  if (sampling != nullptr && sampling->regenerate_from == RegenerateFrom::kNetwork)
    return refused("--regenerate-from network", "no keypoints");
  return {};
}

// What a track must have in common with the one it resumes: options, the cameras and the body, the program.
MadeWith made_with(OptionLines options, const std::vector<PinholeCamera>& cameras, const BodyModel& body) {
  MadeWith all;
  for (auto& [key, value] : options) all.emplace_back(key == "video" ? "VIDEO" : "--" + key, std::move(value));
  for (auto& entry : silpose::made_with(cameras, body)) all.push_back(std::move(entry));
  all.emplace_back("silpose", SILPOSE_VERSION " " SILPOSE_COMMIT);
  return all;
}

// A track between its options and its files.
struct Track {
  TrackOptions options;
  std::shared_ptr<const BodyModel> body;
  CameraChoice cameras;
  std::unique_ptr<ObservationSource> source;
  TrackerOptions tracker;
};

Result<Track> prepare(TrackOptions options, const CommonOptions& common, Console& console) {
  Track track;
  Result<std::shared_ptr<const BodyModel>> body = choose_body(options.model, console);
  if (!body) return body.failure();
  track.body = std::move(*body);
  const auto pose = read_initial_pose(options, track.body->skeleton, 0);  // reported before the clip is read
  if (!pose) return pose.failure();
  Result<Video> video = open_input(options.input);
  if (!video) return video.failure();
  Result<CameraChoice> cameras = choose_cameras(options.camera, sizes_of(*video));
  if (!cameras) return cameras.failure();
  track.cameras = std::move(*cameras);
  auto source = observations_of(std::move(*video), options.input, console);
  if (!source) return source.failure();
  track.source = std::move(*source);
  options.fit_body = fits_body(options, track.source->finds_keypoints());
  if (estimates_camera(options)) {
    const Result<void> estimated = estimate_camera_of(*track.source, track.body->height_m, track.cameras, console);
    if (!estimated) return estimated.failure();
  }
  Result<TrackerOptions> tracker = tracker_options(options, track.body, track.cameras.cameras, common.seed);
  if (!tracker) return tracker.failure();
  track.tracker = std::move(*tracker);
  if (const Result<void> fits = check_keypoints(options, track.tracker, *track.source); !fits) return fits.failure();
  track.tracker.landmarks = (options.init == "auto" || options.init == "landmarks") && track.source->finds_keypoints();
  track.options = std::move(options);
  return track;
}

// Resumes what an earlier run left in the folder, if anything.
Result<void> resume(Session& session, const CheckpointPlace& place, const TrackOptions& options, Console& console) {
  const auto failed = [&](const Error& why) {
    return error("--resume: {}; without --resume the clip is tracked from the start", why.message);
  };
  auto earlier = read_checkpoint(place.folder, place.made_with);
  if (!earlier) return failed(earlier.error());
  if (!*earlier) {
    if (!options.each) console.message(fmt::format("{}: nothing to resume from", place.folder.string()));
    return {};
  }
  const int64_t num_frames = (*earlier)->num_frames;
  const Result<std::string> where = session.resume(std::move(**earlier));
  if (!where) return Console::interrupted() ? error("interrupted; --resume continues") : failed(where.error());
  console.message(fmt::format("{}: {} frames are done; resuming {}", place.folder.string(), num_frames, *where));
  return {};
}

// Runs the session; its files are in the folder then. Errors: no frame at all.
Result<SessionResult> run(const Track& track, const std::shared_ptr<MaskFiles>& masks, const CheckpointPlace& place,
                          Console& console) {
  const std::filesystem::path& folder = place.folder;
  ObservationSource& source = *track.source;
  const double fps = source.video().fps();
  SessionOptions options;
  options.tracker = track.tracker;
  options.fit_body = *track.options.fit_body;
  options.initial_pose = [&](int64_t frame) { return read_initial_pose(track.options, track.body->skeleton, frame); };
  options.sinks = {masks, std::make_shared<OverlayFile>(folder, track.body, track.cameras.cameras[0],
                                                        OverlayOptions{.fps = fps, .floor = track.options.draw_floor})};
  if (!source.video().is_live()) options.checkpoint = place;
  options.progress = &console;
  Session session(source, std::move(options));
  if (track.options.resume) {
    if (Result<void> resumed = resume(session, place, track.options, console); !resumed) return resumed.failure();
  }
  Result<SessionResult> result = session.finish();
  if (!result) return result;
  if (result->num_frames == 0) {
    if (result->stopped) return error("interrupted before the first frame");
    return error("{}: no frame between --start and --end", source.video().name());
  }
  const Stopwatch writing;
  if (result->body_fit && !result->recording.steps.empty()) {
    if (Result<void> written = write_body(folder / kFittedBodyFile, *result->body); !written) return written.failure();
  }
  const Result<void> written =
      write_result_files(folder, {result->recording, *result->body, track.cameras.cameras, fps});
  if (!written) return written.failure();
  result->seconds.write += writing.seconds();
  result->seconds.camera = track.cameras.estimating_s;
  return result;
}

std::vector<std::string> warnings_of(const Track& track, const SessionResult& result) {
  std::vector<std::string> warnings = track.cameras.warnings;
  const std::vector<std::string> of_input = warnings_of(*track.source, track.options.input);
  warnings.insert(warnings.end(), of_input.begin(), of_input.end());
  warnings.insert(warnings.end(), result.warnings.begin(), result.warnings.end());
  if (!has_opensim_coordinates(result.body->skeleton)) {
    warnings.emplace_back("no motion.mot: the model's skeleton is not the human one");
  }
  const bool knows_size = result.body_fit && result.body_fit->size;
  if (track.cameras.cameras.size() == 1 && !knows_size && result.used.size_deviation > 0) {
    warnings.push_back(fmt::format(
        "--model {}: a height of {:.2f} m is assumed, as none is given; 90 % of people are within {:.0f} % of "
        "it, and distances may be off by as much",
        track.options.model, track.body->height_m, 100 * kSpreadsOf90Percent * result.used.size_deviation));
  }
  if (!result.recording.steps.empty() && summarise(result.recording).frames_tracked == 0) {
    warnings.emplace_back("no person was seen: there is no pose in this result");
  }
  return warnings;
}

Result<Outcome> track_clip_of(const CLI::App& app, TrackOptions options, const CommonOptions& common,
                              Console& console) {
  Result<ResultDirectory> directory = ResultDirectory::create(options.out, options.resume);
  if (!directory) return directory.failure();
  const Result<Track> track = prepare(std::move(options), common, console);
  if (!track) return track.failure();
  const std::vector<PinholeCamera>& cameras = track->cameras.cameras;
  const auto masks = std::make_shared<MaskFiles>(directory->path(), cameras);
  const auto chosen = chosen_options(track->options, track->tracker);
  const CheckpointPlace place{directory->path(), made_with(option_lines(app, chosen), cameras, *track->body), masks};
  const Result<SessionResult> result = run(*track, masks, place, console);
  if (!result) return result.failure();

  const FinishedTrack finished{
      track->options, common, track->cameras, *masks, *track->source, *result, warnings_of(*track, *result)};
  for (const std::string& warning : finished.warnings) console.warning(warning);
  if (!result->recording.steps.empty()) {
    const Result<void> written = write_track_report(finished, directory->path());
    if (!written) return written.failure();
  }
  Outcome outcome = track_outcome(finished, result->stopped ? directory->path() : directory->final_path());
  return deliver(*directory, app, chosen_options(track->options, result->used), std::move(outcome), console);
}

Result<Outcome> run_track(const CLI::App& app, const TrackOptions& options, const CommonOptions& common,
                          Console& console) {
  if (options.out.empty()) throw UsageError("--out is missing");
  if (options.input.videos.empty()) throw UsageError("VIDEO is missing");
  check_together(options);
  if (!options.each) return track_clip_of(app, options, common, console);
  return track_each(options, console,
                    [&](const TrackOptions& of_clip) { return track_clip_of(app, of_clip, common, console); });
}

}  // namespace

Command add_track(CLI::App& program, const CommonOptions& common) {
  const auto options = std::make_shared<TrackOptions>();
  CLI::App* const app = program.add_subcommand("track", "Track a person: VIDEO... --out DIR");
  add_track_options(*app, *options);
  return {app, [app, options, &common](Console& console) { return run_track(*app, *options, common, console); },
          &options->config};
}

}  // namespace silpose::app
