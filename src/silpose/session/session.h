// Session: from frames to poses, in one loop: source, segmenters, tracker, sinks. Frame by frame, or, where a recorded
// clip is smoothed or the body is fitted to its subject, in passes: all frames are segmented, then tracked as a whole.
// Images are not kept.
//   auto source = ObservationSource::open(open_video("walk.mp4").value()).value();
//   Session session(*source, {.tracker = {.body = body, .cameras = cameras}});
//   while (const auto report = session.next().value()) ...
// Threads: one thread per session; sinks are called from another one (sink.h).
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "silpose/base/progress.h"
#include "silpose/base/result.h"
#include "silpose/offline/body_fit.h"
#include "silpose/recording/track_recording.h"
#include "silpose/session/checkpoint.h"
#include "silpose/session/observation_source.h"
#include "silpose/session/sink.h"
#include "silpose/session/stage_seconds.h"
#include "silpose/track/tracker_options.h"

namespace silpose {

// Where a session saves its state every few seconds, and when it is stopped, for a later one to resume.
struct CheckpointPlace {
  std::filesystem::path folder;
  MadeWith made_with;
  std::shared_ptr<MaskFiles> masks;  // one of the sinks: what a clip that is tracked as a whole is read back from
};

struct SessionOptions {
  TrackerOptions tracker;  // with body and cameras
  bool fit_body = false;   // to the subject of a recorded clip, as far as the clip determines it (offline/body_fit.h)
  // The pose [D] to start from, given the number of the first frame; nullopt: one is searched. May be empty.
  std::function<Result<std::optional<std::vector<double>>>(int64_t frame_idx)> initial_pose;
  std::vector<std::shared_ptr<SessionSink>> sinks;
  std::optional<CheckpointPlace> checkpoint;  // not of a live camera
  ProgressSink* progress = nullptr;           // must outlive the session
};

struct SessionResult {
  TrackRecording recording;               // without steps where a clip that is tracked as a whole was stopped early
  std::shared_ptr<const BodyModel> body;  // as given, or fitted
  std::optional<BodyFit> body_fit;        // where the body was fitted
  TrackerOptions used;
  int64_t num_frames = 0;  // segmented
  StageSeconds seconds;
  double loop_s = 0;     // from the first frame to the last, all stages
  bool stopped = false;  // by the progress sink
  std::vector<std::string> warnings;
  std::vector<std::string> doubtful;  // angles, and when
};

class Session {
 public:
  // `source` must outlive the session, and have given no instant. Errors: throws std::invalid_argument as
  // TrackerOptions::check(); fit_body, smoothing or a checkpoint with a live source; a checkpoint whose masks are not
  // among the sinks.
  Session(ObservationSource& source, SessionOptions options);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  // Restores what an earlier session saved, which read_checkpoint() gave, and reads over the frames that are done.
  // Returns where it resumes, for the user: "after frame 41", "in the pass over the whole clip", ...
  // Errors: those of the source; another clip; masks that are gone; interrupted by the progress sink. REQUIRES: before
  // next(); SessionOptions::checkpoint.
  Result<std::string> resume(Checkpoint earlier);

  // The report of the next frame, in order and from the first frame of the clip on, whether resumed or not. nullopt at
  // the end, or where the progress sink asked to stop. Where the clip is tracked as a whole the first call does it.
  // Reports have no StepReport::observed. Errors: those of the source, the sinks and the checkpoint; again at every
  // later call.
  Result<std::optional<StepReport>> next();

  // Tracks what is left, gives sinks the frames that they need and finishes them. Errors: as next(). REQUIRES: called
  // once, last.
  Result<SessionResult> finish();

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace silpose
