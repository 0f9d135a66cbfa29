// Which cameras: those of a calibration file, or one assumed where no file is given.
// Threads: the main thread only.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/geometry/camera.h"

namespace silpose::app {

struct CameraOptions {
  std::string file;
  std::vector<std::string> names;
  std::string up, unit;
};

struct CameraChoice {
  std::vector<PinholeCamera> cameras;  // [C]
  std::vector<std::string> warnings;
};

void add_camera_options(CLI::App& command, CameraOptions& options);

struct PictureSize {
  int width = 0, height = 0;
};

// One camera a picture size, in order; without sizes all that the file, or --camera-name, names. Errors: those of the
// file; a name that is not in it; another number of cameras; a camera calibrated for another size.
Result<CameraChoice> choose_cameras(const CameraOptions& options, const std::vector<PictureSize>& sizes);

}  // namespace silpose::app
