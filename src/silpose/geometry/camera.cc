#include "silpose/geometry/camera.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "silpose/base/check.h"

namespace silpose {
namespace {

// Distorts normalised image coordinates; `jacobian`, where asked for, is d distorted / d x.
Eigen::Vector2d distort(const std::array<double, 5>& distortion, const Eigen::Vector2d& x,
                        Eigen::Matrix2d* jacobian = nullptr) {
  const auto [k1, k2, p1, p2, k3] = distortion;
  const double a = x.x(), b = x.y();
  const double r2 = a * a + b * b;
  const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  if (jacobian) {
    const double slope = 2 * (k1 + r2 * (2 * k2 + r2 * 3 * k3));  // d radial / d a = slope * a
    const double mixed = slope * a * b + 2 * p1 * a + 2 * p2 * b;
    *jacobian << radial + slope * a * a + 2 * p1 * b + 6 * p2 * a, mixed,  //
        mixed, radial + slope * b * b + 6 * p1 * b + 2 * p2 * a;
  }
  return {a * radial + 2 * p1 * a * b + p2 * (r2 + 2 * a * a), b * radial + p1 * (r2 + 2 * b * b) + 2 * p2 * a * b};
}

}  // namespace

bool PinholeCamera::has_distortion() const {
  return std::any_of(distortion.begin(), distortion.end(), [](double k) { return k != 0; });
}

Eigen::Vector2d PinholeCamera::project_from_camera(const Eigen::Vector3d& x_in_cam) const {
  const double inverse_depth = 1 / x_in_cam.z();
  Eigen::Vector2d x(x_in_cam.x() * inverse_depth, x_in_cam.y() * inverse_depth);
  if (has_distortion()) x = distort(distortion, x);
  return {fx * x.x() + cx, fy * x.y() + cy};
}

std::optional<Eigen::Vector2d> PinholeCamera::project(const Eigen::Vector3d& x_in_world) const {
  const Eigen::Vector3d x_in_cam = cam_from_world * x_in_world;
  if (!(x_in_cam.z() >= kNear)) return std::nullopt;
  return project_from_camera(x_in_cam);
}

Eigen::Matrix<double, 2, 3> PinholeCamera::project_jacobian(const Eigen::Vector3d& x_in_world) const {
  const Eigen::Vector3d x_in_cam = cam_from_world * x_in_world;
  const double inverse_depth = 1 / x_in_cam.z();
  const Eigen::Vector2d x(x_in_cam.x() * inverse_depth, x_in_cam.y() * inverse_depth);
  Eigen::Matrix2d by_normalised;
  distort(distortion, x, &by_normalised);
  by_normalised.row(0) *= fx;
  by_normalised.row(1) *= fy;
  Eigen::Matrix<double, 2, 3> normalised_by_cam;
  normalised_by_cam << inverse_depth, 0, -x.x() * inverse_depth,  //
      0, inverse_depth, -x.y() * inverse_depth;
  return by_normalised * normalised_by_cam * cam_from_world.rotation;
}

Eigen::Vector3d PinholeCamera::ray_from_pixel(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d distorted((pixel.x() - cx) / fx, (pixel.y() - cy) / fy);
  Eigen::Vector2d x = distorted;
  if (has_distortion()) {
    // Newton's method. Steps that do not come nearer are halved: strong distortion folds far outside the image.
    Eigen::Matrix2d jacobian;
    Eigen::Vector2d residual = distort(distortion, x, &jacobian) - distorted;
    for (int iteration = 0; iteration < 50 && residual.squaredNorm() > 1e-28; ++iteration) {
      if (std::abs(jacobian.determinant()) < 1e-12) break;
      const Eigen::Vector2d step = jacobian.inverse() * residual;
      double scale = 1;
      bool nearer = false;
      for (; scale > 1e-4 && !nearer; scale /= 2) {
        const Eigen::Vector2d candidate = x - scale * step;
        Eigen::Matrix2d candidate_jacobian;
        const Eigen::Vector2d candidate_residual = distort(distortion, candidate, &candidate_jacobian) - distorted;
        nearer = candidate_residual.squaredNorm() < residual.squaredNorm();
        if (nearer) x = candidate, residual = candidate_residual, jacobian = candidate_jacobian;
      }
      if (!nearer) break;
    }
  }
  return {x.x(), x.y(), 1};
}

Eigen::Vector3d PinholeCamera::centre_in_world() const {
  return -(cam_from_world.rotation.transpose() * cam_from_world.translation);
}

PinholeCamera PinholeCamera::resized(int new_width, int new_height) const {
  check(new_width > 0 && new_height > 0, "resized camera of {} x {} pixels", new_width, new_height);
  const double x_scale = static_cast<double>(new_width) / width, y_scale = static_cast<double>(new_height) / height;
  PinholeCamera camera = *this;
  camera.width = new_width;
  camera.height = new_height;
  camera.fx *= x_scale;
  camera.cx *= x_scale;
  camera.fy *= y_scale;
  camera.cy *= y_scale;
  return camera;
}

PinholeCamera default_camera(int width, int height, double distance) {
  const Eigen::Vector3d camera_centre(0, 1.5, distance);
  return look_at_camera(width, height, 1.2 * std::max(width, height), camera_centre,
                        camera_centre - Eigen::Vector3d::UnitZ());
}

PinholeCamera look_at_camera(int width, int height, double focal_px, const Eigen::Vector3d& camera_centre,
                             const Eigen::Vector3d& target) {
  check(width > 0 && height > 0 && focal_px > 0, "camera of {} x {} pixels, focal length {}", width, height, focal_px);
  const Eigen::Vector3d along = target - camera_centre;
  check(along.norm() > 1e-9, "a camera cannot look at its own position");
  const Eigen::Vector3d forward = along.normalized();
  Eigen::Vector3d right = forward.cross(Eigen::Vector3d::UnitY());
  if (right.norm() < 1e-6) right = Eigen::Vector3d::UnitX();  // straight up or down: +X stays to the right
  right.normalize();
  PinholeCamera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = camera.fy = focal_px;
  camera.cx = width / 2.0;
  camera.cy = height / 2.0;
  camera.cam_from_world.rotation.row(0) = right;
  camera.cam_from_world.rotation.row(1) = forward.cross(right);
  camera.cam_from_world.rotation.row(2) = forward;
  camera.cam_from_world.translation = -(camera.cam_from_world.rotation * camera_centre);
  return camera;
}

}  // namespace silpose
