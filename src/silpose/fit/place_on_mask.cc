#include "silpose/fit/place_on_mask.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "silpose/base/check.h"
#include "silpose/base/parallel.h"
#include "silpose/render/projected_mesh.h"
#include "silpose/render/silhouette.h"
#include "silpose/shape/normalised_silhouette.h"

namespace silpose {
namespace {

constexpr double kPlacingResolution = 96;  // [guess] raster pixels along the longer side of the silhouette

struct Blob {
  double area = 0;
  Eigen::Vector2d centroid = Eigen::Vector2d::Zero();  // raster pixels
};

Blob measure(const Mask& mask) {
  Blob blob;
  for (int y = 0; y < mask.height(); ++y) {
    const auto row = mask.row(y);
    for (size_t w = 0; w < row.size(); ++w) {
      for (uint64_t bits = row[w]; bits != 0; bits &= bits - 1) {
        blob.area += 1;
        blob.centroid += Eigen::Vector2d(static_cast<double>(w) * 64 + std::countr_zero(bits) + 0.5, y + 0.5);
      }
    }
  }
  if (blob.area > 0) blob.centroid /= blob.area;
  return blob;
}

Eigen::Vector2d image_from_raster(const Window& window, const Eigen::Vector2d& x) {
  return {window.x0 + x.x() / window.scale_x, window.y0 + x.y() / window.scale_y};
}

}  // namespace

StateBatch place_on_mask(const BodyModel& body, const PinholeCamera& camera, const Observation& observation,
                         const StateBatch& candidates) {
  const Box box = observation.box();
  check(!box.empty(), "place_on_mask: nothing was found");
  const double longer_side = std::max(box.width, box.height);
  const Window window = window_of_image(camera.width, camera.height, std::min(1.0, kPlacingResolution / longer_side));
  const Blob observed = measure(resample_mask(observation.mask, window));
  if (observed.area < 1 || body.profile.root_translations.empty()) return candidates;
  check(body.profile.silhouette_area > 0, "place_on_mask: the area of the body's silhouettes is not known");
  // The silhouette's size over the body's height, to two digits: the descent corrects the rest.
  const double size = std::max(0.01, std::round(100 * std::sqrt(body.profile.silhouette_area)) / 100);
  const Eigen::Vector2d target = image_from_raster(window, observed.centroid);
  const EdgeTopology topology(body.rest.faces);

  StateBatch placed = candidates;
  parallel_for(static_cast<size_t>(placed.rows()), 1, [&](size_t begin, size_t end) {
    OutlineRenderer outline(topology);
    Mask mask(window.width, window.height);
    ProjectedMesh mesh;
    for (size_t k = begin; k < end; ++k) {
      auto row = placed.row(static_cast<Eigen::Index>(k));
      const std::span<double> pose(row.data(), static_cast<size_t>(body.skeleton.num_dofs()));
      // Depth first from an upright body.
      double depth =
          size * body.height_m * std::sqrt(camera.fx * camera.fy) * window.scale_x / std::sqrt(observed.area);
      Eigen::Vector2d aim = target;
      for (int iteration = 0; iteration < 5; ++iteration) {
        const Eigen::Vector3d root =
            camera.cam_from_world.inverse() * Eigen::Vector3d(camera.ray_from_pixel(aim) * depth);
        place_root(body.skeleton, body.profile, pose, root);
        project_mesh(camera, skin_vertices(body, pose), body.rest.faces, mesh);
        outline.draw(mesh.pixels, window, mask, mesh.cut_faces);
        const Blob drawn = measure(mask);
        if (drawn.area < 1) break;
        depth *= std::clamp(std::sqrt(drawn.area / observed.area), 0.5, 2.0);
        aim += target - image_from_raster(window, drawn.centroid);
      }
    }
  });
  return placed;
}

}  // namespace silpose
