#include "silpose/render/projected_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "silpose/base/check.h"
#include "silpose/render/silhouette.h"
#include "silpose/render/view_volume.h"

namespace silpose {
namespace {

// Room around the image, as parts of its view: a straight lens draws rightly wherever it is, a bent one near its
// image only.
constexpr double kStraightMargin = 1, kBentMargin = 0.05;

struct Corner {
  Eigen::Vector3d x_in_cam, weights;
};

// A convex polygon and what half-spaces leave of it.
class Polygon {
 public:
  explicit Polygon(const std::array<Corner, 3>& triangle) { std::ranges::copy(triangle, corners_.begin()); }

  void cut(const Eigen::Vector4d& half_space) {
    std::array<Corner, kMost> kept;
    size_t num_kept = 0;
    const auto height = [&](const Corner& corner) { return half_space.dot(corner.x_in_cam.homogeneous()); };
    for (size_t i = 0; i < count_; ++i) {
      const Corner &from = corners_[i], &to = corners_[(i + 1) % count_];
      const double at_from = height(from), at_to = height(to);
      if (at_from >= 0) kept[num_kept++] = from;
      if ((at_from >= 0) == (at_to >= 0)) continue;
      // From the inner end always: two faces get the same point of an edge that they share.
      kept[num_kept++] =
          at_from >= 0 ? between(from, to, at_from / (at_from - at_to)) : between(to, from, at_to / (at_to - at_from));
    }
    corners_ = kept;
    count_ = num_kept;
  }

  [[nodiscard]] std::span<const Corner> corners() const { return std::span(corners_).first(count_); }

 private:
  static constexpr size_t kMost = 3 + std::tuple_size_v<decltype(ViewVolume::half_spaces)>;  // each cut adds one
  static Corner between(const Corner& a, const Corner& b, double t) {
    return {a.x_in_cam + t * (b.x_in_cam - a.x_in_cam), a.weights + t * (b.weights - a.weights)};
  }

  std::array<Corner, kMost> corners_;
  size_t count_ = 3;
};

bool is_unseen(const Eigen::Vector2f& pixel) { return std::isnan(pixel.x()); }

}  // namespace

void project_mesh(const PinholeCamera& camera, std::span<const Eigen::Vector3f> vertices_in_world,
                  std::span<const Face> faces, ProjectedMesh& mesh) {
  const size_t num_vertices = vertices_in_world.size();
  mesh.cut_vertices.clear();
  mesh.cut_faces.clear();
  mesh.pixels.resize(num_vertices);
  project_vertices(camera, vertices_in_world, mesh.pixels);
  const auto num_unseen = static_cast<size_t>(std::ranges::count_if(mesh.pixels, is_unseen));
  if (num_unseen == 0 || num_unseen == num_vertices) return;

  const ViewVolume view(camera, camera.has_distortion() ? kBentMargin : kStraightMargin);
  for (uint32_t f = 0; f < faces.size(); ++f) {
    int unseen = 0;
    for (const uint32_t vertex : faces[f]) {
      check(vertex < num_vertices, "project_mesh: face names a vertex of {}", num_vertices);
      unseen += static_cast<int>(is_unseen(mesh.pixels[vertex]));
    }
    if (unseen == 0 || unseen == 3) continue;
    std::array<Corner, 3> triangle;
    bool is_finite = true;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d x_in_world = vertices_in_world[faces[f][static_cast<size_t>(k)]].cast<double>();
      triangle[static_cast<size_t>(k)] = {camera.cam_from_world * x_in_world, Eigen::Vector3d::Unit(k)};
      is_finite = is_finite && x_in_world.allFinite();
    }
    if (!is_finite) continue;
    Polygon polygon(triangle);
    for (const Eigen::Vector4d& half_space : view.half_spaces) polygon.cut(half_space);
    const auto first = static_cast<uint32_t>(mesh.pixels.size());
    for (Corner corner : polygon.corners()) {
      corner.x_in_cam.z() = std::max(corner.x_in_cam.z(), PinholeCamera::kNear);  // but for rounding it is
      mesh.pixels.push_back(camera.project_from_camera(corner.x_in_cam).cast<float>());
      mesh.cut_vertices.push_back({.face = f, .weights = corner.weights, .depth = corner.x_in_cam.z()});
    }
    for (uint32_t k = first + 2; k < mesh.pixels.size(); ++k) mesh.cut_faces.push_back({first, k - 1, k});
  }
}

}  // namespace silpose
