// estimate_camera(): focal length, tilt, roll and height of an uncalibrated camera, from where the head and the feet of
// an upright person on the floor are seen, and how tall the person is. A person who comes nearer determines how high
// the camera is and where the horizon is; one who is seen leaning at the image's sides, where the image is tilted,
// determines the focal length. What a clip does not determine stays at its prior (of the focal length: the caller's),
// as its deviation shows.
// Based on: metrology of a single view (references.bib: criminisi2000), as a maximum a posteriori fit with residuals of
// Student's t, since people stoop, jump and raise their arms. Threads: functions without state.
#pragma once

#include <optional>
#include <span>

#include "silpose/calibrate/focal_prior.h"
#include "silpose/calibrate/person_extent.h"
#include "silpose/geometry/camera.h"

namespace silpose {

struct Estimated {
  double mean = 0, deviation = 0;
};

struct CameraEstimate {
  PinholeCamera camera;  // above the world's origin by the height, the person in the middle of the clip near the origin
  Estimated focal_px, tilt, roll, height_m;  // radians: tilt is positive where it looks down
  double body_height_m = 0;                  // taken as known
  size_t num_frames = 0;                     // that the estimate used
};

inline constexpr size_t kFewestExtents = 8;

// `body_height_m` is taken as known: the camera's height grows in proportion to it. A `focal_length` without deviation
// is taken as it is. Frames in which the person crouches are left out. Nothing where fewer than kFewestExtents are
// left, or they are scattered. Errors: throws std::invalid_argument for sizes that are not positive.
[[nodiscard]] std::optional<CameraEstimate> estimate_camera(std::span<const PersonExtent> extents, int width,
                                                            int height, double body_height_m,
                                                            const FocalPrior& focal_length);

}  // namespace silpose
