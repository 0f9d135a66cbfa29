// ViewVolume: what a camera may see, as half-spaces: beyond the near plane, and within the image and some margin
// around it (far outside of it a distortion polynomial folds back, and would project things into the image that are
// not there).
// Threads: immutable.
#pragma once

#include <Eigen/Core>
#include <array>

#include "silpose/geometry/camera.h"

namespace silpose {

struct ViewVolume {
  // `margin`: on each side, as a fraction of the image's view.
  ViewVolume(const PinholeCamera& camera, double margin);
  std::array<Eigen::Vector4d, 5> half_spaces;  // of camera coordinates: inside is n . x + d >= 0; the near plane first
};

}  // namespace silpose
