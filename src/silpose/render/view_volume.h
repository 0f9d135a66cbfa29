// ViewVolume: what a camera may see, as half-spaces: before the near plane, and within the picture and some room around
// it (far outside of it a distortion polynomial folds back, and would put things where there are none).
// Threads: immutable.
#pragma once

#include <Eigen/Core>
#include <array>

#include "silpose/geometry/camera.h"

namespace silpose {

struct ViewVolume {
  // `margin`: room on each side, as a part of the picture's view.
  ViewVolume(const PinholeCamera& camera, double margin);
  std::array<Eigen::Vector4d, 5> half_spaces;  // of camera coordinates: inside is n . x + d >= 0; the near plane first
};

}  // namespace silpose
