// TrackJob: a clip between its options and the files of its result: body, cameras, observations and tracker are chosen
// by what the clip holds, the clip is tracked by a Session, and its files are written.
// Threads: the same thread for all; uses all cores.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/session/camera_choice.h"
#include "silpose/session/mask_files.h"
#include "silpose/session/observation_source.h"
#include "silpose/session/run_context.h"
#include "silpose/session/session.h"
#include "silpose/session/track_options.h"

namespace silpose {

struct TrackJob {
  TrackOptions options;  // with fit_body set
  std::shared_ptr<const BodyModel> body;
  CameraChoice cameras;
  std::unique_ptr<ObservationSource> source;
  TrackerOptions tracker;
};

// Errors: those of choose_body(), open_clip(), read_initial_pose(), estimate_camera_of(), tracker_options() and
// check_keypoints(). Throws OptionError as these do.
Result<TrackJob> prepare_track(TrackOptions options, const RunContext& context);

// Tracks the clip: masks, the overlay and what is made of the recording (write_result_files(), kFittedBodyFile) are in
// the place's folder then, where the session also saves its state. `resumes`: what an earlier run left there, if
// anything, is resumed, and the context is told where. Errors: no frame at all; those of Session, write_body() and
// write_result_files(); what is there cannot be resumed from. REQUIRES: called once.
Result<SessionResult> run_track(const TrackJob& job, const CheckpointPlace& place, bool resumes,
                                const RunContext& context);

// What the user should know about the result, one line each: of cameras, input, session and body.
std::vector<std::string> warnings_of(const TrackJob& job, const SessionResult& result);

}  // namespace silpose
