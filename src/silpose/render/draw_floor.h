// The floor y = 0 drawn into images, and where a body's feet are on it: to check that the calibration fits the
// image, and the pose fits the floor. 8-bit B, G, R, as in draw_overlay.h. Lines follow the lens and end at the
// camera's plane. Threads: pure functions.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "silpose/body/body_model.h"
#include "silpose/geometry/camera.h"
#include "silpose/image/image.h"
#include "silpose/image/mask.h"

namespace silpose {

// A grid on the floor: squares of 1 m whose lines lie at whole metres, 6 m by 6 m around `middle` (x and z, world), and
// the world's axes, 1 m long from the origin: x red, y green, z blue. What `in_front` covers (empty, or of the
// image's size) is left alone: a body on the floor hides what lies behind it. REQUIRES: image of 3 channels, of the
// camera's size.
void draw_floor(ByteImage& image, const PinholeCamera& camera, const Eigen::Vector2d& middle, const Mask& in_front);

// What a foot would print on the floor if it were pressed straight down.
struct Footprint {
  int joint_idx = 0;                     // whose foot
  std::vector<Eigen::Vector2d> outline;  // x, z in metres: convex, at least a triangle
  Eigen::Vector3d lowest;                // point of the foot, world
};

// Of every contact joint of the rig's profile, the mesh below it in the skeleton included.
[[nodiscard]] std::vector<Footprint> footprints(const BodyModel& body, std::span<const double> pose);

// The footprints of a posed body on the floor: left ones blue, right ones orange, filled while the foot is within 2 cm
// of it; a line joins the foot's lowest point to the floor below (or above) it.
void draw_footprints(ByteImage& image, const BodyModel& body, const PinholeCamera& camera,
                     std::span<const double> pose);

}  // namespace silpose
