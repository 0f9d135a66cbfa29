// silpose track: from a clip to poses.
#include <fmt/format.h>

#include <memory>
#include <utility>

#include "apps/silpose/body_choice.h"
#include "apps/silpose/camera_estimate.h"
#include "apps/silpose/command.h"
#include "apps/silpose/option_file.h"
#include "apps/silpose/result_directory.h"
#include "apps/silpose/run_facts.h"
#include "apps/silpose/track_checkpoint.h"
#include "apps/silpose/track_each.h"
#include "apps/silpose/track_options.h"
#include "apps/silpose/track_result.h"
#include "apps/silpose/track_run.h"
#include "apps/silpose/track_writer.h"
#include "silpose/evaluate/interval_coverage.h"

namespace silpose::app {
namespace {

Result<Outcome> track_clip_of(const CLI::App& app, TrackOptions options, const CommonOptions& common,
                              Console& console) {
  Result<ResultDirectory> directory = ResultDirectory::create(options.out, options.resume);
  if (!directory) return directory.failure();
  const Result<std::shared_ptr<const BodyModel>> body = choose_body(options.model, console);
  if (!body) return body.failure();
  const auto pose =
      read_initial_pose(options, (*body)->skeleton, 0);  // errors in it are reported before the clip is read
  if (!pose) return pose.failure();
  Result<ObservationSource> source = ObservationSource::open(options.input);
  if (!source) return source.failure();
  Result<CameraChoice> cameras = choose_cameras(options.camera, source->sizes());
  if (!cameras) return cameras.failure();
  if (const Result<void> learned = source->learn(console); !learned) return learned.failure();
  options.fit_body = fits_body(options, source->finds_keypoints());
  if (estimates_camera(options)) {
    const Result<void> estimated = estimate_camera_of(*source, (*body)->height_m, *cameras, console);
    if (!estimated) return estimated.failure();
  }
  Result<TrackerOptions> asked = tracker_options(options, *body, cameras->cameras, common.seed);
  if (!asked) return asked.failure();
  TrackerOptions tracker = std::move(*asked);
  TrackResume resume{
      .folder = directory->path(),
      .made_with = made_with(option_lines(app, chosen_options(options, tracker)), cameras->cameras, **body),
      .earlier = {}};
  if (options.resume) {
    auto earlier = read_checkpoint(resume.folder, resume.made_with);
    if (!earlier) return earlier.failure();
    if (!*earlier && !options.each) console.message(fmt::format("{}: nothing to resume from", resume.folder.string()));
    resume.earlier = std::move(*earlier);
  }
  if (options.init == "landmarks" && !source->finds_keypoints()) {
    return error("--init landmarks: {} finds none; --segmenter learned does", source->background());
  }
  if (tracker.evidence == EvidenceKind::kKeypoints && !source->finds_keypoints()) {
    return error("--evidence landmarks: {} finds none; --segmenter learned does", source->background());
  }
  const SamplingOptions* const sampling = tracker.sampling();
  if (sampling != nullptr && sampling->regenerate_from == RegenerateFrom::kNetwork && !source->finds_keypoints()) {
    return error("--regenerate-from network: {} finds no keypoints; --segmenter learned does", source->background());
  }
  tracker.landmarks = (options.init == "auto" || options.init == "landmarks") && source->finds_keypoints();

  TrackWriter writer(directory->path(), *body, cameras->cameras, source->video().fps(), options.draw_floor);
  Result<Tracked> tracked = track_video(options, std::move(tracker), *source, writer, console, std::move(resume));
  if (!tracked) return tracked.failure();
  tracked->seconds.camera = cameras->estimating_s;

  std::vector<std::string> warnings = cameras->warnings;
  const std::vector<std::string> of_input = source->warnings();
  warnings.insert(warnings.end(), of_input.begin(), of_input.end());
  warnings.insert(warnings.end(), tracked->warnings.begin(), tracked->warnings.end());
  const bool knows_size = tracked->body_fit && tracked->body_fit->size;
  if (cameras->cameras.size() == 1 && !knows_size && tracked->used.size_deviation > 0) {
    warnings.push_back(fmt::format(
        "--model {}: a height of {:.2f} m is assumed, as none is given; 90 % of people are within {:.0f} % of "
        "it, and distances may be off by as much",
        options.model, (*body)->height_m, 100 * kSpreadsOf90Percent * tracked->used.size_deviation));
  }
  const bool is_recorded = !tracked->recording.steps.empty();
  if (is_recorded && summarise(tracked->recording).frames_tracked == 0) {
    warnings.emplace_back("no person was seen: there is no pose in this result");
  }
  for (const std::string& warning : warnings) console.warning(warning);
  const FinishedTrack finished{options, common, *cameras, writer, *source, *tracked, warnings};
  if (is_recorded) {
    const Result<void> written = write_track_report(finished, directory->path());
    if (!written) return written.failure();
  }
  Outcome outcome = track_outcome(finished, tracked->interrupted ? directory->path() : directory->final_path());
  return deliver(*directory, app, chosen_options(options, tracked->used), std::move(outcome), console);
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
