#include "silpose/synth/backdrop.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "silpose/base/check.h"
#include "silpose/base/parallel.h"
#include "silpose/base/rng.h"

namespace silpose {
namespace {

using Eigen::Vector3d;

// A hash of a grid point, uniform in [0, 1).
double grid_value(int64_t x, int64_t y, uint64_t seed) {
  return Rng(seed, static_cast<uint64_t>(x) * 0x9E3779B97F4A7C15u, static_cast<uint64_t>(y)).uniform();
}

// Smooth noise between grid points one apart, 0 to 1.
double value_noise(double x, double y, uint64_t seed) {
  const double x0 = std::floor(x), y0 = std::floor(y);
  const auto ease = [](double t) { return t * t * (3 - 2 * t); };
  const double u = ease(x - x0), v = ease(y - y0);
  const auto ix = static_cast<int64_t>(x0), iy = static_cast<int64_t>(y0);
  const double top = (1 - u) * grid_value(ix, iy, seed) + u * grid_value(ix + 1, iy, seed);
  const double bottom = (1 - u) * grid_value(ix, iy + 1, seed) + u * grid_value(ix + 1, iy + 1, seed);
  return (1 - v) * top + v * bottom;
}

// Three octaves, centred on 0, about -0.5 to 0.5. Coordinates in metres, coarsest detail `size` metres.
double texture(double x, double y, double size, uint64_t seed) {
  return 0.5 * (value_noise(x / size, y / size, seed) - 0.5) +
         0.3 * (value_noise(3.1 * x / size, 3.1 * y / size, seed + 1) - 0.5) +
         0.2 * (value_noise(9.7 * x / size, 9.7 * y / size, seed + 2) - 0.5);
}

// Images that hang on the wall.
struct Poster {
  double x, y, half_width, half_height;  // metres on the wall
  Vector3d colour;                       // B, G, R in 0 to 1
};

std::vector<Poster> hang_posters(uint64_t seed) {
  constexpr int kPosters = 9;
  std::vector<Poster> posters;
  posters.reserve(kPosters);
  Rng rng(seed, 1);
  for (int i = 0; i < kPosters; ++i) {
    posters.push_back({-4.8 + 1.2 * i + rng.uniform(-0.2, 0.2),
                       rng.uniform(0.9, 2.3),
                       rng.uniform(0.2, 0.5),
                       rng.uniform(0.2, 0.5),
                       {rng.uniform(0.15, 0.8), rng.uniform(0.15, 0.8), rng.uniform(0.15, 0.8)}});
  }
  return posters;
}

// Bricks of 0.5 x 0.25 m, posters on them.
Vector3d wall_colour(double x, double y, const std::vector<Poster>& posters, uint64_t seed) {
  for (const Poster& poster : posters) {
    if (std::abs(x - poster.x) < poster.half_width && std::abs(y - poster.y) < poster.half_height) {
      return poster.colour * (1 + 0.8 * texture(x, y, 0.3, seed + 20));
    }
  }
  const double row = std::floor(y / 0.25);
  const double along = x / 0.5 + 0.5 * (static_cast<int64_t>(row) & 1), brick = std::floor(along);
  const bool is_mortar = (along - brick) * 0.5 < 0.02 || y - row * 0.25 < 0.02;
  if (is_mortar) return Vector3d(0.62, 0.65, 0.66) * (1 + 0.3 * texture(x, y, 0.2, seed + 30));
  const double shade = 0.85 + 0.3 * grid_value(static_cast<int64_t>(brick), static_cast<int64_t>(row), seed + 40);
  return Vector3d(0.42, 0.5, 0.62) * shade * (1 + 0.5 * texture(x, y, 0.4, seed + 50));
}

// Boards of 0.2 m.
Vector3d floor_colour(double x, double z, uint64_t seed) {
  const double board = std::floor(x / 0.2);
  if (x - board * 0.2 < 0.008) return {0.16, 0.2, 0.25};
  const double shade = 0.8 + 0.4 * grid_value(static_cast<int64_t>(board), 0, seed + 60);
  return Vector3d(0.3, 0.42, 0.55) * shade * (1 + 0.6 * texture(4 * x, 0.5 * z, 0.5, seed + 70));
}

// Cloth that is lit a little unevenly.
Vector3d green_colour(double x, double y, bool is_floor, uint64_t seed) {
  return Vector3d(0.25, 0.69, 0.1) * (is_floor ? 0.88 : 1.0) * (1 + 0.15 * texture(x, y, 2.5, seed + 80));
}

}  // namespace

Result<Backdrop> parse_backdrop(const std::string& text) {
  if (text == "textured") return Backdrop::kTextured;
  if (text == "green") return Backdrop::kGreen;
  return error("backdrop '{}': textured or green", text);
}

ByteImage draw_backdrop(const PinholeCamera& camera, Backdrop backdrop, double wall_distance_m, uint64_t seed) {
  check(wall_distance_m > 0, "draw_backdrop: wall {} m away", wall_distance_m);
  const std::vector<Poster> posters = hang_posters(seed);
  const Vector3d camera_centre = camera.centre_in_world();
  const Eigen::Matrix3d world_from_cam = camera.cam_from_world.rotation.transpose();
  Vector3d ahead = world_from_cam * Vector3d::UnitZ();
  ahead.y() = 0;
  // A camera that looks straight down has no wall ahead of it; any upright wall will do.
  ahead = ahead.norm() > 1e-6 ? ahead.normalized() : -Vector3d::UnitZ();
  const Vector3d right = ahead.cross(Vector3d::UnitY());

  ByteImage image(camera.width, camera.height, 3);
  parallel_for(static_cast<size_t>(camera.height), 16, [&](size_t begin, size_t end) {
    for (size_t row = begin; row < end; ++row) {
      for (int column = 0; column < camera.width; ++column) {
        const Vector3d ray = world_from_cam * camera.ray_from_pixel({column + 0.5, static_cast<double>(row) + 0.5});
        const double to_wall = ray.dot(ahead) > 1e-6 ? wall_distance_m / ray.dot(ahead) : 1e6;
        const double to_floor = ray.y() < -1e-6 && camera_centre.y() > 0 ? -camera_centre.y() / ray.y() : 1e6;
        const bool is_floor = to_floor < to_wall;
        const Vector3d x = camera_centre + std::min(to_wall, to_floor) * ray;
        const double along = (x - camera_centre).dot(right);
        Vector3d colour;
        if (backdrop == Backdrop::kGreen) {
          colour = is_floor ? green_colour(x.x(), x.z(), true, seed) : green_colour(along, x.y(), false, seed);
        } else {
          colour = is_floor ? floor_colour(x.x(), x.z(), seed) : wall_colour(along, x.y(), posters, seed);
        }
        for (int c = 0; c < 3; ++c) {
          image.at(column, static_cast<int>(row), c) =
              static_cast<uint8_t>(std::lround(std::clamp(colour[c] * 255, 0.0, 255.0)));
        }
      }
    }
  });
  return image;
}

}  // namespace silpose
