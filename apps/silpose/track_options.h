// The options of `silpose track`, and the tracker they ask for.
// Threads: the main thread only.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/silpose/camera_choice.h"
#include "apps/silpose/input_options.h"
#include "silpose/base/option_table.h"
#include "silpose/base/result.h"
#include "silpose/track/tracker_options.h"

namespace silpose::app {

struct TrackOptions {
  InputOptions input;
  CameraOptions camera;
  std::string model = "human", out, config, init = "auto", preset = "default";
  GivenOptions tracker;  // those of the tracker, by name, on top of the preset
  std::optional<double> level_iou;
  std::optional<bool> fit_body;
  bool each = false, resume = false, draw_floor = false;
};

void add_track_options(CLI::App& app, TrackOptions& options);

// Throws UsageError for options that do not go together, before anything is read.
void check_together(const TrackOptions& options);

// Whether the body is fitted to the subject: where requested, and by `accurate` where bone lengths can be determined.
// Throws UsageError where it is requested and nothing can be determined.
bool fits_body(const TrackOptions& options, bool finds_keypoints);

// Whether the camera is estimated: of one recorded clip without a calibration file.
bool estimates_camera(const TrackOptions& options);

// The tracker's options, all but its first pose. Throws UsageError for options that it rejects. Errors: no level of the
// body's is as fine as --iou asks for.
Result<TrackerOptions> tracker_options(const TrackOptions& options, std::shared_ptr<const BodyModel> body,
                                       std::vector<PinholeCamera> cameras, uint64_t seed);

// The pose that --init specifies for a frame of the clip, or the file's first pose where it lacks that frame. [D]
// Nothing with `descent`. Errors: those of read_poses(); no pose in it.
Result<std::optional<std::vector<double>>> read_initial_pose(const TrackOptions& options, const Skeleton& skeleton,
                                                             int64_t frame);

// Every option of the tracker, and what else was chosen for this clip, by option name, for config.toml.
std::map<std::string, std::string> chosen_options(const TrackOptions& options, const TrackerOptions& used);

}  // namespace silpose::app
