// Which cameras: those of a calibration file, or one that is assumed or estimated from the clip where none is given.
// Threads: values and functions without state; the tables are constant.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "silpose/base/option_table.h"
#include "silpose/base/result.h"
#include "silpose/calibrate/focal_prior.h"
#include "silpose/calibrate/person_camera.h"
#include "silpose/geometry/calibration_file.h"
#include "silpose/geometry/camera.h"
#include "silpose/session/observation_source.h"
#include "silpose/session/run_context.h"
#include "silpose/video/video.h"

namespace silpose {

inline constexpr const char* kAssumedCamera = "assumed";

struct CameraOptions {
  std::string file;                           // empty: none; or kAssumedCamera
  std::vector<std::string> names;             // of its cameras, one per video; empty: all, in their order
  std::optional<UpAxis> up;                   // of the file's world; absent: as the file says
  std::optional<double> metres_per_unit;      // of the file's lengths; absent: as the file says
  std::optional<double> focal_mm35, fov_deg;  // of a camera without a file: 35 mm equivalent, or field of view
  [[nodiscard]] bool has_file() const { return !file.empty() && file != kAssumedCamera; }
};

const OptionTable<CameraOptions>& camera_option_table();
// Of the focal length, for what can do without a file.
const OptionTable<CameraOptions>& focal_option_table();

// What is known of the focal length of a camera without a file, and from where: "metadata", "assumed", or the option.
struct FocalSource {
  FocalPrior prior;
  std::string from;
};

struct CameraChoice {
  std::vector<PinholeCamera> cameras;  // [C]
  std::vector<std::string> warnings;
  std::optional<FocalSource> focal;        // without a file
  std::optional<CameraEstimate> estimate;  // where the camera is one
  double estimating_s = 0;
};

// Pixels.
struct ImageSize {
  int width = 0, height = 0;
  std::optional<double> focal_mm35 = {};  // by the clip's metadata
};

// Of each camera of a video, [C].
std::vector<ImageSize> sizes_of(const Video& video);

// One camera per image size, in order, assumed where there is no file; without sizes all that the file, or the names,
// say. Errors: those of the file; a name that is not in it; another number of cameras; a camera calibrated for another
// size. Throws OptionError for options that do not go together. REQUIRES: a file or a size.
Result<CameraChoice> choose_cameras(const CameraOptions& options, const std::vector<ImageSize>& sizes);

// Puts the estimated camera, with a warning that says how well it is known, in place of the assumed one; where the clip
// shows too little of the person, the assumed one stays, and its warning says why. The source is rewound then.
// `body_height_m`: the subject's stature. Errors: those of estimate_clip_camera(); stopped by the progress sink.
// REQUIRES: a choice without a file.
Result<void> estimate_camera_of(ObservationSource& source, double body_height_m, CameraChoice& choice,
                                const RunContext& context);

// The same focal length as mean and standard deviation, pixels.
Estimated focal_px(const FocalPrior& prior);

}  // namespace silpose
