// SegmentProjector: straight segments of the world as curves in a camera's image, the lens' distortion respected.
// Clipped before they are projected: to what lies in front of the camera, and to a little more than the image shows.
// Source: clipping against half-spaces, Liang and Barsky (references.bib: liang1984).
// Threads: immutable; const functions are safe.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "silpose/geometry/camera.h"
#include "silpose/render/view_volume.h"

namespace silpose {

class SegmentProjector {
 public:
  explicit SegmentProjector(const PinholeCamera& camera);

  // Pixels along the segment between two world points, in order, evenly spaced before distortion; empty where nothing
  // of it can be seen. Two without distortion.
  [[nodiscard]] std::vector<Eigen::Vector2d> operator()(const Eigen::Vector3d& from, const Eigen::Vector3d& to) const;

 private:
  PinholeCamera camera_;
  ViewVolume view_;
};

}  // namespace silpose
