#include "silpose/session/track_job.h"

#include <fmt/format.h>

#include <utility>

#include "silpose/base/clock.h"
#include "silpose/evaluate/interval_coverage.h"
#include "silpose/exchange/mot.h"
#include "silpose/session/body_choice.h"
#include "silpose/session/overlay_file.h"
#include "silpose/session/result_files.h"

namespace silpose {
namespace {

// Resumes what an earlier run left in the folder, if anything.
Result<void> resume(Session& session, const CheckpointPlace& place, const RunContext& context) {
  const auto failed = [](const Error& why) {
    return error("--resume: {}; without --resume the clip is tracked from the start", why.message);
  };
  auto earlier = read_checkpoint(place.folder, place.made_with);
  if (!earlier) return failed(earlier.error());
  if (!*earlier) return {};
  const int64_t num_frames = (*earlier)->num_frames;
  const Result<std::string> where = session.resume(std::move(**earlier));
  if (!where) return failed(where.error());
  context.tell(fmt::format("{}: {} frames are done; resuming {}", place.folder.string(), num_frames, *where));
  return {};
}

SessionOptions session_options(const TrackJob& job, const CheckpointPlace& place, const RunContext& context) {
  const Video& video = job.source->video();
  SessionOptions options;
  options.tracker = job.tracker;
  options.fit_body = job.options.fit_body.value();
  options.initial_pose = [&job](int64_t frame) { return read_initial_pose(job.options, job.body->skeleton, frame); };
  options.sinks = {place.masks,
                   std::make_shared<OverlayFile>(place.folder, job.body, job.cameras.cameras[0],
                                                 OverlayOptions{.fps = video.fps(), .floor = job.options.draw_floor})};
  if (!video.is_live()) options.checkpoint = place;
  options.progress = context.progress;
  return options;
}

Result<void> write_files(const std::filesystem::path& folder, const TrackJob& job, const SessionResult& result) {
  if (result.body_fit && !result.recording.steps.empty()) {
    if (Result<void> written = write_body(folder / kFittedBodyFile, *result.body); !written) return written;
  }
  return write_result_files(folder, {result.recording, *result.body, job.cameras.cameras, job.source->video().fps()});
}

}  // namespace

Result<TrackJob> prepare_track(TrackOptions options, const RunContext& context) {
  TrackJob job;
  Result<std::shared_ptr<const BodyModel>> body = choose_body(options.model, context);
  if (!body) return body.failure();
  job.body = std::move(*body);
  const auto pose = read_initial_pose(options, job.body->skeleton, 0);  // reported before the clip is read
  if (!pose) return pose.failure();
  Result<OpenClip> clip = open_clip(options.input, options.camera, context);
  if (!clip) return clip.failure();
  job.cameras = std::move(clip->cameras);
  job.source = std::move(clip->source);
  const bool finds_keypoints = job.source->finds_keypoints();
  options.fit_body = fits_body(options, finds_keypoints);
  if (estimates_camera(options)) {
    const Result<void> estimated = estimate_camera_of(*job.source, job.body->height_m, job.cameras, context);
    if (!estimated) return estimated.failure();
  }
  Result<TrackerOptions> tracker = tracker_options(options, job.body, job.cameras.cameras);
  if (!tracker) return tracker.failure();
  job.tracker = std::move(*tracker);
  if (!finds_keypoints) {
    const Result<void> fits = check_keypoints(options, job.tracker, job.source->segmentation());
    if (!fits) return fits.failure();
  }
  job.tracker.landmarks = (options.init == "auto" || options.init == "landmarks") && finds_keypoints;
  job.options = std::move(options);
  return job;
}

Result<SessionResult> run_track(const TrackJob& job, const CheckpointPlace& place, bool resumes,
                                const RunContext& context) {
  Session session(*job.source, session_options(job, place, context));
  if (resumes) {
    if (Result<void> resumed = resume(session, place, context); !resumed) return resumed.failure();
  }
  Result<SessionResult> result = session.finish();
  if (!result) return result;
  if (result->num_frames == 0) {
    if (result->stopped) return error("interrupted before the first frame");
    return error("{}: no frame between --start and --end", job.source->video().name());
  }
  const Stopwatch writing;
  if (Result<void> written = write_files(place.folder, job, *result); !written) return written.failure();
  result->seconds.write += writing.seconds();
  result->seconds.camera = job.cameras.estimating_s;
  return result;
}

std::vector<std::string> warnings_of(const TrackJob& job, const SessionResult& result) {
  std::vector<std::string> warnings = job.cameras.warnings;
  const std::vector<std::string> of_input = warnings_of(*job.source, job.options.input);
  warnings.insert(warnings.end(), of_input.begin(), of_input.end());
  warnings.insert(warnings.end(), result.warnings.begin(), result.warnings.end());
  if (!has_opensim_coordinates(result.body->skeleton)) {
    warnings.emplace_back("no motion.mot: the model's skeleton is not the human one");
  }
  const bool knows_size = result.body_fit && result.body_fit->size;
  if (job.cameras.cameras.size() == 1 && !knows_size && result.used.size_deviation > 0) {
    warnings.push_back(fmt::format(
        "--model {}: a height of {:.2f} m is assumed, as none is given; 90 % of people are within {:.0f} % of "
        "it, and distances may be off by as much",
        job.options.model, job.body->height_m, 100 * kSpreadsOf90Percent * result.used.size_deviation));
  }
  if (!result.recording.steps.empty() && summarise(result.recording).frames_tracked == 0) {
    warnings.emplace_back("no person was seen: there is no pose in this result");
  }
  return warnings;
}

}  // namespace silpose
