// TrackOptions: what is tracked of one clip, and how, as a user says it; and the tracker that this asks for.
// Threads: values and functions without state.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "silpose/base/option_table.h"
#include "silpose/base/result.h"
#include "silpose/session/camera_choice.h"
#include "silpose/session/input_options.h"
#include "silpose/track/tracker_options.h"

namespace silpose {

struct TrackOptions {
  InputOptions input;
  CameraOptions camera;
  std::string model = "human";      // choose_body()
  std::string init = "auto";        // first pose: auto, descent, landmarks, or a file of poses
  std::string preset = "default";   // tracker_presets.h
  GivenOptions tracker;             // those of the tracker, by name, on top of the preset
  std::optional<double> level_iou;  // in place of the option `vertices`: choose_level()
  std::optional<bool> fit_body;     // absent: fits_body()
  bool draw_floor = false;          // OverlayOptions::floor
  uint64_t seed = 1;

  // Errors: throws OptionError for options that do not go together, before anything is read.
  void check() const;
};

// The input that cannot be read twice ("camera:0"); empty where all are recorded.
std::string live_input(const std::vector<std::string>& videos);

// Whether the body is fitted to the subject: where requested, and by `accurate` where bone lengths can be determined.
// Errors: throws OptionError where it is requested and nothing can be determined.
bool fits_body(const TrackOptions& options, bool finds_keypoints);

// Whether the camera is estimated: of one recorded clip without a calibration file.
bool estimates_camera(const TrackOptions& options);

// The tracker's options, all but its first pose and whether it starts by landmarks. Errors: no level of the body's is
// as fine as level_iou asks for. Throws OptionError for options that the tracker rejects.
Result<TrackerOptions> tracker_options(const TrackOptions& options, std::shared_ptr<const BodyModel> body,
                                       std::vector<PinholeCamera> cameras);

// Errors: an option that needs keypoints, where the segmenter, whose name is given, finds none.
Result<void> check_keypoints(const TrackOptions& options, const TrackerOptions& tracker, const std::string& segmenter);

// The pose that `init` specifies for a frame of the clip, or the file's first pose where it lacks that frame. [D]
// Nothing where it is no file. Errors: those of read_poses(); no pose in it.
Result<std::optional<std::vector<double>>> read_initial_pose(const TrackOptions& options, const Skeleton& skeleton,
                                                             int64_t frame);

// Every option of the tracker, and whether the body was fitted, by option name, for config.toml and the report.
// REQUIRES: TrackOptions::fit_body is set.
std::map<std::string, std::string> chosen_options(const TrackOptions& options, const TrackerOptions& used);

}  // namespace silpose
