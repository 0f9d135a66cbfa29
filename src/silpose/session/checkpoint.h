// Checkpoint: what an interrupted session resumes from, a file beside the masks of the frames done: what it was made
// with, the reports so far, and what tracker and segmenters carry from frame to frame.
// Threads: values and functions without state.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/body/body_model.h"
#include "silpose/geometry/camera.h"
#include "silpose/image/frame.h"
#include "silpose/session/mask_files.h"
#include "silpose/session/stage_seconds.h"
#include "silpose/track/step_report.h"

namespace silpose {

inline constexpr std::string_view kCheckpointFile = "checkpoint.bin";

struct Checkpoint {
  int64_t num_frames = 0;                        // segmented
  uint32_t last_image = 0;                       // image_checksum() of the last of them
  std::string source;                            // ObservationSource::state()
  std::vector<std::string> sinks;                // SessionSink::state() of each
  std::vector<std::vector<MaskSidecar>> seen;    // [T][C] of a clip that is tracked as a whole
  std::vector<std::vector<double>> given_poses;  // [T][D] of the body as given, where it is fitted; empty: not yet
  std::vector<StepReport> reports;               // of each frame online, and of the whole clip once it is tracked
  std::string tracker;                           // Tracker::state(), or what track_clip() gave; empty: not begun
  StageSeconds seconds;
  double loop_s = 0;

  static auto members(auto& c) {
    return std::tie(c.num_frames, c.last_image, c.source, c.sinks, c.seen, c.given_poses, c.reports, c.tracker,
                    c.seconds, c.loop_s);
  }
};

// What a session must have in common with the one it resumes, as name and value: options, program. Names are used in
// messages.
using MadeWith = std::vector<std::pair<std::string, std::string>>;

// Checksums of the cameras and of the body, as entries of MadeWith.
MadeWith made_with(const std::vector<PinholeCamera>& cameras, const BodyModel& body);

// Of some rows of all images: fast, and different for any other clip.
uint32_t image_checksum(const Frame& frame);

// Errors: not writable; the earlier one stays.
Result<void> write_checkpoint(const std::filesystem::path& folder, const MadeWith& made_with,
                              const Checkpoint& checkpoint);

// nullopt where the folder has none. Errors: damaged; made with something else, which is named.
Result<std::optional<Checkpoint>> read_checkpoint(const std::filesystem::path& folder, const MadeWith& made_with);

}  // namespace silpose
