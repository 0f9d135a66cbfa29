#include <algorithm>

#include "silpose/base/check.h"
#include "silpose/render/coverage_count.h"
#include "silpose/render/projected_mesh.h"
#include "silpose/render/raster_grid.h"
#include "silpose/render/silhouette.h"
#include "silpose/render/triangle_fill.h"

namespace silpose {
void draw_silhouette_reference(std::span<const Eigen::Vector2f> pixels, std::span<const Face> faces,
                               const Window& window, Mask& mask, std::span<const Face> cut_faces) {
  mask = Mask(window.width, window.height);
  std::vector<GridPoint> points(pixels.size());
  round_to_grid(pixels, window, points);
  const auto fill = [&](const Face& face) {
    check(std::max({face[0], face[1], face[2]}) < points.size(), "draw_silhouette_reference: face names a vertex of {}",
          points.size());
    const GridPoint a = points[face[0]], b = points[face[1]], c = points[face[2]];
    if (!a.unseen() && !b.unseen() && !c.unseen()) {
      fill_triangle(a, b, c, window.width, window.height,
                    [&](int x, int y, int64_t, int64_t, int64_t) { mask.set(x, y); });
    }
  };
  std::ranges::for_each(faces, fill);
  std::ranges::for_each(cut_faces, fill);
}

ByteImage draw_coverage_reference(std::span<const Eigen::Vector2f> pixels, std::span<const Face> faces,
                                  const Window& window, std::span<const Face> cut_faces) {
  Mask samples;
  draw_silhouette_reference(pixels, faces, sample_window(window), samples, cut_faces);
  ByteImage coverage(window.width, window.height);
  for (int y = 0; y < samples.height(); ++y) {
    for (int x = 0; x < samples.width(); ++x) {
      uint8_t& of_pixel = coverage.at(x / kCoverageSamples, y / kCoverageSamples);
      of_pixel = static_cast<uint8_t>(of_pixel + samples.get(x, y));
    }
  }
  return coverage;
}

Mask render_silhouette(const BodyModel& body, const PinholeCamera& camera, std::span<const double> pose) {
  ProjectedMesh mesh;
  project_mesh(camera, skin_vertices(body, pose), body.rest.faces, mesh);
  Mask mask;
  draw_silhouette_reference(mesh.pixels, body.rest.faces, Window{.width = camera.width, .height = camera.height}, mask,
                            mesh.cut_faces);
  return mask;
}

}  // namespace silpose
