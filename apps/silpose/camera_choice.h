// Which cameras: those of a calibration file, or one assumed where no file is given (clip_camera_choice.h improves on
// it). Threads: the main thread only.
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/calibrate/focal_prior.h"
#include "silpose/calibrate/person_camera.h"
#include "silpose/geometry/camera.h"
#include "silpose/video/video.h"

namespace silpose::app {

inline constexpr const char* kAssumedCamera = "assumed";

struct CameraOptions {
  std::string file;  // or kAssumedCamera
  std::vector<std::string> names;
  std::string up, unit;
  std::optional<double> focal_mm35, fov_deg;  // of a camera without a file
  [[nodiscard]] bool has_file() const { return !file.empty() && file != kAssumedCamera; }
};

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

void add_camera_options(CLI::App& command, CameraOptions& options);
// --focal-mm35 and --fov-deg, for commands that can do without a file.
void add_focal_options(CLI::App& command, CameraOptions& options);

struct ImageSize {
  int width = 0, height = 0;
  std::optional<double> focal_mm35 = {};  // by the clip's metadata
};

// Of each camera of a video.
std::vector<ImageSize> sizes_of(const Video& video);

// One camera per picture size, in order, assumed where there is no file; without sizes all that the file, or
// --camera-name, names. Errors: those of the file; a name that is not in it; another number of cameras; a camera
// calibrated for another size. Throws UsageError for options that do not go together.
Result<CameraChoice> choose_cameras(const CameraOptions& options, const std::vector<ImageSize>& sizes);

// "focal length 960 ± 192 px (as phones and webcams have it)", of an estimate or of what was known before.
std::string focal_text(const Estimated& focal_px, const FocalSource& source);

// {"mean", "std", "from"} in pixels: what was known before the clip was analysed.
nlohmann::ordered_json facts_of(const FocalSource& source);

}  // namespace silpose::app
