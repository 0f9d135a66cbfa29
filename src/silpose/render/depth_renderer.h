// DepthRenderer: poses in batches to depth images, or at once to how far they are from an observed one.
// What is drawn is what draw_depth() (shaded.h) draws, but for rounding in single precision: the nearest surface at
// each pixel's centre, by its distance along the camera's axis.
// Threads: constant after construction; runs on all cores (base/parallel.h), the result does not depend on how many.
#pragma once

#include <memory>
#include <span>

#include "silpose/body/body_model.h"
#include "silpose/geometry/camera.h"
#include "silpose/image/image.h"
#include "silpose/render/silhouette.h"
#include "silpose/shape/window.h"

namespace silpose {

class DepthRenderer {
 public:
  DepthRenderer(std::shared_ptr<const BodyModel> body, const PinholeCamera& camera);

  // Depth images, metres, 0 where there is no surface. Poses with a number that is not finite show nothing. Shapes: out
  // [N, window.height, window.width]. REQUIRES: num_dofs = D.
  void images(const BatchView& poses, const Window& window, std::span<float> out) const;

  // depth_ssd() (shape/distance.h) of each pose's depth image and `observed`, whose size is the window's; only what a
  // thread works on is kept of the images. Shapes: out [N].
  void distances(const BatchView& poses, const Window& window, const Image<float>& observed, double missing_m,
                 std::span<double> out) const;

  [[nodiscard]] const BodyModel& body() const;
  [[nodiscard]] const PinholeCamera& camera() const;

 private:
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

}  // namespace silpose
