#include <algorithm>
#include <cmath>
#include <limits>

#include "silpose/base/check.h"
#include "silpose/render/raster_grid.h"
#include "silpose/render/silhouette.h"

namespace silpose {

void project_vertices(const PinholeCamera& camera, std::span<const Eigen::Vector3f> vertices_in_world,
                      std::span<Eigen::Vector2f> pixels) {
  check(pixels.size() == vertices_in_world.size(), "project_vertices: {} vertices, room for {}",
        vertices_in_world.size(), pixels.size());
  constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
  for (size_t i = 0; i < pixels.size(); ++i) {
    const auto pixel = camera.project(vertices_in_world[i].cast<double>());
    pixels[i] = pixel ? pixel->cast<float>() : Eigen::Vector2f(kNaN, kNaN);
  }
}

std::optional<PixelBounds> pixel_bounds(std::span<const Eigen::Vector2f> pixels) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  PixelBounds bounds{kInfinity, kInfinity, -kInfinity, -kInfinity};
  for (const Eigen::Vector2f& pixel : pixels) {
    const double x = pixel.x(), y = pixel.y();
    if (std::isnan(x) || std::isnan(y)) continue;
    bounds = {std::min(bounds.x0, x), std::min(bounds.y0, y), std::max(bounds.x1, x), std::max(bounds.y1, y)};
  }
  if (!(bounds.x0 <= bounds.x1)) return std::nullopt;
  return bounds;
}

bool round_to_grid(std::span<const Eigen::Vector2f> pixels, const Window& window, std::span<GridPoint> points) {
  const GridAxis x_axis(window.x0, window.scale_x), y_axis(window.y0, window.scale_y);
  bool some_unseen = false;
  for (size_t first = 0; first < pixels.size(); first += 4) {
    const size_t count = std::min<size_t>(4, pixels.size() - first);
    Eigen::Array4f x = Eigen::Array4f::Zero(), y = x;
    for (size_t i = 0; i < count; ++i) {
      x[static_cast<Eigen::Index>(i)] = pixels[first + i].x();
      y[static_cast<Eigen::Index>(i)] = pixels[first + i].y();
    }
    const Int4 grid_x = x_axis.round(x), grid_y = y_axis.round(y);
    for (size_t i = 0; i < count; ++i) {
      const auto lane = static_cast<Eigen::Index>(i);
      const bool unseen = std::isnan(x[lane]) || std::isnan(y[lane]);
      points[first + i] = unseen ? kUnseenPoint : GridPoint{grid_x[lane], grid_y[lane]};
      some_unseen |= unseen;
    }
  }
  return some_unseen;
}

}  // namespace silpose
