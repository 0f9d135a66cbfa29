// The work of `silpose track`: observations in, poses out, masks and overlay written on the way. Frame by frame, or
// with smoothing in three passes: the clip is segmented, then tracked as a whole (twice where the body is fitted), then
// read again for the overlay.
// Pictures are never kept. Threads: the main thread only.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "apps/silpose/console.h"
#include "apps/silpose/observation_source.h"
#include "apps/silpose/track_checkpoint.h"
#include "apps/silpose/track_options.h"
#include "apps/silpose/track_writer.h"
#include "silpose/base/result.h"
#include "silpose/recording/track_recording.h"
#include "silpose/track/body_fit.h"

namespace silpose::app {

// Where a run saves its state for a later run to resume, and what an earlier one saved.
struct TrackResume {
  std::filesystem::path folder;
  OptionLines made_with;
  std::optional<TrackCheckpoint> earlier;
};

struct Tracked {
  TrackRecording recording;  // without steps where smoothing was interrupted
  TrackerOptions used;
  int64_t num_frames = 0;           // segmented
  std::optional<BodyFit> body_fit;  // where the body was fitted
  StageSeconds seconds;
  double loop_s = 0;  // from the first frame to the last, all stages
  bool interrupted = false;
  std::vector<std::string> warnings;
  std::vector<std::string> doubtful;  // angles, and when
};

// `tracker`: tracker_options(). Progress is saved to a checkpoint every few seconds, and when interrupted. Errors:
// those of the video, the segmenter and the files; no frame between --start and --end; interrupted before the first
// frame; an earlier run of another clip.
Result<Tracked> track_video(const TrackOptions& options, TrackerOptions tracker, ObservationSource& source,
                            TrackWriter& writer, Console& console, TrackResume resume);

}  // namespace silpose::app
