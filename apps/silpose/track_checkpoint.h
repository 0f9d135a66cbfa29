// TrackCheckpoint: what an interrupted track resumes from, a file in DIR.partial next to the masks of the frames done:
// what it was made with, the reports so far, and what tracker and segmenters carry from frame to frame.
// Threads: values and functions without state.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "apps/silpose/option_file.h"
#include "apps/silpose/track_writer.h"
#include "silpose/base/result.h"
#include "silpose/body/body_model.h"
#include "silpose/geometry/camera.h"
#include "silpose/image/frame.h"
#include "silpose/report/mask_strip.h"
#include "silpose/track/step_report.h"

namespace silpose::app {

inline constexpr std::string_view kCheckpointFile = "checkpoint.bin";

// Seconds by stage. `camera` (estimating it) and `background` were spent before the first frame, `start` on finding a
// starting pose, `smooth` on tracking a clip as a whole, which is not divided further.
struct StageSeconds {
  double camera = 0, background = 0, decode = 0, segment = 0, start = 0, propagate = 0, likelihood = 0, resample = 0,
         smooth = 0, write = 0;

  [[nodiscard]] std::vector<std::pair<std::string, double>> list() const;
  static auto members(auto& s) {
    return std::tie(s.camera, s.background, s.decode, s.segment, s.start, s.propagate, s.likelihood, s.resample,
                    s.smooth, s.write);
  }
};

struct TrackCheckpoint {
  int64_t num_frames = 0;                        // segmented
  uint32_t last_picture = 0;                     // picture_checksum() of the last of them
  std::string source;                            // ObservationSource::state()
  std::vector<MaskStrip> strips;                 // [C] TrackWriter::strips()
  std::vector<std::vector<MaskSidecar>> seen;    // [T][C] of a clip that is tracked as a whole
  std::vector<std::vector<double>> given_poses;  // [T][D] of the body as given, where it is fitted; empty: not yet
  std::vector<StepReport> reports;               // of each frame online, and of the whole clip once it is tracked
  std::string tracker;                           // Tracker::state(), or what track_clip() gave; empty: not begun
  StageSeconds seconds;
  double loop_s = 0;

  static auto members(auto& c) {
    return std::tie(c.num_frames, c.last_picture, c.source, c.strips, c.seen, c.given_poses, c.reports, c.tracker,
                    c.seconds, c.loop_s);
  }
};

// What a track must have in common with the one it resumes: options, the cameras and the body, the program.
OptionLines made_with(OptionLines options, const std::vector<PinholeCamera>& cameras, const BodyModel& body);

// Of some rows of all pictures: fast, and different for any other clip.
uint32_t picture_checksum(const Frame& frame);

// Errors: not writable; the earlier one stays.
Result<void> write_checkpoint(const std::filesystem::path& folder, const OptionLines& made_with,
                              const TrackCheckpoint& checkpoint);

// Nothing where the folder has none. Errors: damaged; made with something else, which is named.
Result<std::optional<TrackCheckpoint>> read_checkpoint(const std::filesystem::path& folder,
                                                       const OptionLines& made_with);

}  // namespace silpose::app
