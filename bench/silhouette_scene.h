// SilhouetteScene: the work that every silhouette benchmark does: poses of a body in front of one camera, drawn into a
// window of 128x128 or another size, compared with one observed silhouette. And the plain renderer's result.
// Threads: constant after construction.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "silpose/body/body_model.h"
#include "silpose/geometry/camera.h"
#include "silpose/image/image.h"
#include "silpose/image/mask.h"
#include "silpose/render/silhouette.h"
#include "silpose/shape/window.h"

namespace silpose::bench {

// The body that scripts/build makes. Errors: throws std::runtime_error where it is not there.
std::shared_ptr<const BodyModel> human();

struct SilhouetteScene {
  std::shared_ptr<const BodyModel> body;
  PinholeCamera camera;
  Window window;
  std::vector<double> poses;  // [N, D] row-major
  size_t num_poses = 0, num_dofs = 0;
  Mask observed;  // of the window's size

  [[nodiscard]] std::span<const double> pose(size_t n) const {
    return std::span(poses).subspan(n * num_dofs, num_dofs);
  }
  // The first `count` poses.
  [[nodiscard]] BatchView batch(size_t count) const { return {poses.data(), count, num_dofs, num_dofs}; }
};

// Standing poses that use a third of every angle's range, in the middle of a 640x480 image; a further one is
// observed.
SilhouetteScene standing_scene(std::shared_ptr<const BodyModel> body, size_t num_poses, int size = 128);

// The plain renderer's silhouette of a pose [D]: every vertex skinned and projected, every triangle filled by itself.
Mask plain_silhouette(const SilhouetteScene& scene, std::span<const double> pose);
ByteImage plain_coverage(const SilhouetteScene& scene, std::span<const double> pose);

// Differing pixels of `count` poses from number `first` on and `observed`, on all cores. [count]
std::vector<int64_t> plain_distances(const SilhouetteScene& scene, size_t first, size_t count, const Mask& observed);
std::vector<int64_t> our_distances(const SilhouetteScene& scene, const BatchRenderer& renderer, size_t first,
                                   size_t count, const Mask& observed);

// The vertex stage for peers that have one: [J] 3x4 matrices from rest coordinates to homogeneous window coordinates,
// in which the window is [-w, w] in x and y, y down, and w the depth in metres. REQUIRES: a lens without distortion.
using ClipFromRest = Eigen::Matrix<float, 3, 4, Eigen::RowMajor>;
void clip_from_rest(const SilhouetteScene& scene, std::span<const double> pose, std::span<ClipFromRest> matrices);

}  // namespace silpose::bench
