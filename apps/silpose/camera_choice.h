// Which cameras: those of a calibration file, or one assumed where no file is given (camera_estimate.h improves on it).
// Threads: the main thread only.
#pragma once

#include <CLI/CLI.hpp>
#include <optional>
#include <string>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/calibrate/person_camera.h"
#include "silpose/geometry/camera.h"

namespace silpose::app {

inline constexpr const char* kAssumedCamera = "assumed";

struct CameraOptions {
  std::string file;  // or kAssumedCamera
  std::vector<std::string> names;
  std::string up, unit;
  [[nodiscard]] bool has_file() const { return !file.empty() && file != kAssumedCamera; }
};

struct CameraChoice {
  std::vector<PinholeCamera> cameras;  // [C]
  std::vector<std::string> warnings;
  std::optional<CameraEstimate> estimate;  // where the camera is one
  double estimating_s = 0;
};

void add_camera_options(CLI::App& command, CameraOptions& options);

struct PictureSize {
  int width = 0, height = 0;
};

// One camera a picture size, in order, assumed where there is no file; without sizes all that the file, or
// --camera-name, names. Errors: those of the file; a name that is not in it; another number of cameras; a camera
// calibrated for another size.
Result<CameraChoice> choose_cameras(const CameraOptions& options, const std::vector<PictureSize>& sizes);

}  // namespace silpose::app
