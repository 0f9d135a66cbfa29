// Bundle adjustment of cameras and board poses: all at once, so that the projected corners come nearest to where they
// were seen.
// Based on: damped Gauss-Newton on the reduced system of the cameras (references.bib: triggs2000).
// For use inside module calibrate. Threads: functions without state.
#pragma once

#include <cstddef>
#include <vector>

#include "silpose/calibrate/board.h"
#include "silpose/geometry/camera.h"
#include "silpose/geometry/rigid3.h"

namespace silpose {

struct BundleView {
  size_t camera = 0, place = 0;
  const std::vector<Eigen::Vector2d>* corners = nullptr;  // [N] pixels, seen
};

struct Bundle {
  std::vector<PinholeCamera> cameras;  // [C] lenses (not k3) and poses; the pose of the first is held
  std::vector<Rigid3> places;          // [P] world_from_board
};

// Sum of squared distances of a view's corners from where the bundle puts them, pixels^2; infinite behind the camera.
[[nodiscard]] double view_error(const Bundle& bundle, const std::vector<Eigen::Vector3d>& points,
                                const BundleView& view);

// The bundle with the least error of all views, downhill from `start`. REQUIRES: every place is in a view.
[[nodiscard]] Bundle adjust(const Bundle& start, const std::vector<Eigen::Vector3d>& points,
                            const std::vector<BundleView>& views);

}  // namespace silpose
