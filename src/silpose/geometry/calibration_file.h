// Calibration files: the TOML form that Pose2Sim, Anipose and FreeMoCap share, read and written.
// One table per camera: name, size, matrix, distortions, rotation (Rodrigues), translation, fisheye; camera from world.
// Pixel convention, up axis and unit of the file are converted here and nowhere else (docs/formats.md).
// Threads: functions without state.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/geometry/camera.h"

namespace silpose {

enum class UpAxis { kY, kZ };

struct CalibrationOptions {
  std::optional<UpAxis> up;               // overrides [metadata] up
  std::optional<double> metres_per_unit;  // overrides [metadata] unit
};

struct Calibration {
  std::vector<PinholeCamera> cameras;  // [C] in file order
  UpAxis up = UpAxis::kY;              // of the file's own world
  bool up_assumed = false;             // not in the file: derived from the cameras' mean up direction
  bool up_reversed = false;            // assumed, and the axis points down: the world was turned over
  std::vector<std::string> warnings;   // one line each
};

// Errors: unreadable file, broken TOML, no camera, missing key, wrong type or length, NaN, size or focal length not
// positive, a fisheye camera; each names file, camera and key.
Result<Calibration> load_calibration(const std::filesystem::path& path, const CalibrationOptions& options = {});

// The cameras alone.
Result<std::vector<PinholeCamera>> load_cameras(const std::filesystem::path& path);

// Writes cameras Y up, in metres, with [metadata] saying so.
Result<void> write_cameras(const std::filesystem::path& path, const std::vector<PinholeCamera>& cameras);

}  // namespace silpose
