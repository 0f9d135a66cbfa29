// Cameras from a printed board that was moved in front of them: lenses from views that differ, camera poses from the
// instants at which two of them see the board, and then everything fitted together.
// Based on: plane-based calibration (references.bib: zhang2000) by OpenCV (opencv), then bundle adjustment
// (triggs2000). Threads: a function without state.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/calibrate/board.h"
#include "silpose/calibrate/sighting.h"
#include "silpose/geometry/camera.h"

namespace silpose {

// How well one camera was determined.
struct CameraFit {
  int num_views = 0;       // of the board, that the fit used
  double rms_px = 0;       // root mean square distance of a corner from where the fit puts it
  double focal_sd_px = 0;  // standard deviation of the focal length that the camera's own views leave
  double coverage = 0;     // part of the image (6 x 4 cells) in which there were corners
};

struct CameraCalibration {
  std::vector<PinholeCamera> cameras;  // [C] distortion k1 k2 p1 p2
  std::vector<CameraFit> fits;         // [C]
  double rms_px = 0;                   // of all cameras
  std::vector<std::string> warnings;   // what makes it doubtful, one line each
};

// World: where the board lay on the floor at `floor_instant`, the floor is y = 0, the board's middle the origin, and +Z
// the one of the board's sides that looks most towards the first camera. Without it the first camera is level and
// 1.5 m above the floor, as default_camera(): a guess, which a warning says.
// Errors: a camera with fewer than 4 views that differ, or views that do not determine the lens; one that never sees
// the board together with the others; no camera saw it at `floor_instant`. Each names the camera.
// REQUIRES: a camera at least; with several a board that has one way up.
Result<CameraCalibration> calibrate_cameras(const Board& board, const std::vector<CameraSightings>& cameras,
                                            std::optional<int64_t> floor_instant);

}  // namespace silpose
