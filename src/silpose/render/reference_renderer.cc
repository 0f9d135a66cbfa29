#include <algorithm>
#include <utility>

#include "silpose/base/check.h"
#include "silpose/render/raster_grid.h"
#include "silpose/render/silhouette.h"

namespace silpose {
namespace {

// Twice the signed area of (a, b, p): positive when p lies to the inner side of a triangle's edge from a to b.
int64_t side_of_edge(GridPoint a, GridPoint b, GridPoint p) {
  return int64_t{b.x - a.x} * (p.y - a.y) - int64_t{b.y - a.y} * (p.x - a.x);
}

// Points on an edge itself are inside only on left and top edges.
bool is_inside(GridPoint a, GridPoint b, GridPoint p) {
  const bool left_or_top = b.y < a.y || (b.y == a.y && b.x > a.x);
  return side_of_edge(a, b, p) >= (left_or_top ? 0 : 1);
}

void fill_triangle(GridPoint a, GridPoint b, GridPoint c, Mask& mask) {
  const int64_t area = side_of_edge(a, b, c);
  if (area == 0) return;
  if (area < 0) std::swap(b, c);
  const auto [x_min, x_max] = std::minmax({a.x, b.x, c.x});
  const auto [y_min, y_max] = std::minmax({a.y, b.y, c.y});
  const int x_end = std::min(mask.width(), first_centre_from(x_max) + 1);
  const int y_end = std::min(mask.height(), first_centre_from(y_max) + 1);
  for (int y = std::max(0, first_centre_from(y_min)); y < y_end; ++y) {
    for (int x = std::max(0, first_centre_from(x_min)); x < x_end; ++x) {
      const GridPoint centre{x * kGridPerPixel + kGridHalfPixel, y * kGridPerPixel + kGridHalfPixel};
      if (is_inside(a, b, centre) && is_inside(b, c, centre) && is_inside(c, a, centre)) mask.set(x, y);
    }
  }
}

}  // namespace

void draw_silhouette_reference(std::span<const Eigen::Vector2f> pixels, std::span<const Face> faces,
                               const Window& window, Mask& mask) {
  mask = Mask(window.width, window.height);
  std::vector<GridPoint> points(pixels.size());
  round_to_grid(pixels, window, points);
  for (const Face& face : faces) {
    check(std::max({face[0], face[1], face[2]}) < points.size(), "draw_silhouette_reference: face names a vertex of {}",
          points.size());
    const GridPoint a = points[face[0]], b = points[face[1]], c = points[face[2]];
    if (!a.unseen() && !b.unseen() && !c.unseen()) fill_triangle(a, b, c, mask);
  }
}

Mask render_silhouette(const BodyModel& body, const PinholeCamera& camera, std::span<const double> pose) {
  const auto vertices = skin_vertices(body, pose);
  std::vector<Eigen::Vector2f> pixels(vertices.size());
  project_vertices(camera, vertices, pixels);
  Mask mask;
  draw_silhouette_reference(pixels, body.rest.faces, Window{.width = camera.width, .height = camera.height}, mask);
  return mask;
}

}  // namespace silpose
