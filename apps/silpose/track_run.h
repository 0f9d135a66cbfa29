// The work of `silpose track`: observations in, poses out, masks and overlay written on the way. Frame by frame, or
// with smoothing in three passes: the clip is segmented, then tracked as a whole (twice where the body is fitted), then
// read again for the overlay.
// Pictures are never kept. Threads: the main thread only.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "apps/silpose/console.h"
#include "apps/silpose/observation_source.h"
#include "apps/silpose/track_options.h"
#include "apps/silpose/track_writer.h"
#include "silpose/base/result.h"
#include "silpose/recording/track_recording.h"
#include "silpose/track/body_fit.h"

namespace silpose::app {

// Seconds by stage. `background` is what was spent before the first frame, `start` on finding a starting pose, `smooth`
// on tracking a clip as a whole, which is not told apart further.
struct StageSeconds {
  double background = 0, decode = 0, segment = 0, start = 0, propagate = 0, likelihood = 0, resample = 0, smooth = 0,
         write = 0;

  [[nodiscard]] std::vector<std::pair<std::string, double>> list() const;
};

struct Tracked {
  TrackRecording recording;  // without steps where smoothing was interrupted
  TrackerOptions used;       // everything filled in
  int64_t num_frames = 0;    // segmented
  std::optional<BodyFit> body_fit;  // where the body was fitted
  StageSeconds seconds;
  double loop_s = 0;  // from the first frame to the last, all stages
  bool interrupted = false;
  std::vector<std::string> warnings;
};

// `tracker`: tracker_options(). Errors: those of the video, the segmenter and the files; no frame between --start and
// --end; interrupted before the first frame.
Result<Tracked> track_video(const TrackOptions& options, TrackerOptions tracker, ObservationSource& source,
                            TrackWriter& writer, Console& console);

}  // namespace silpose::app
