// PinholeCamera: from world points (metres, Y up) to pixels, with OpenCV's radial and tangential distortion.
// Camera axes: x right, y down, z forward. Pixels: the top-left pixel covers [0, 1) x [0, 1), its centre is (0.5, 0.5);
// files use OpenCV's convention, half a pixel less (docs/concepts.md).
// Source: OpenCV's camera model (references.bib: opencv).
// Threads: a value; const functions are safe.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>

#include "silpose/geometry/rigid3.h"

namespace silpose {

struct PinholeCamera {
  std::string name = "camera";
  int width = 0, height = 0;              // pixels
  double fx = 0, fy = 0, cx = 0, cy = 0;  // pixels; cx, cy with the centre of the top-left pixel at 0.5
  std::array<double, 5> distortion{};     // k1 k2 p1 p2 k3
  Rigid3 cam_from_world;

  // Points nearer to the camera plane than this, or behind it, are not seen. Metres.
  static constexpr double kNear = 0.05;

  [[nodiscard]] bool has_distortion() const;

  // Pixel of a point in camera coordinates. REQUIRES: z > 0.
  [[nodiscard]] Eigen::Vector2d project_from_camera(const Eigen::Vector3d& x_in_cam) const;

  // Pixel of a world point; nothing when it is nearer than kNear or behind.
  [[nodiscard]] std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& x_in_world) const;

  // d pixel / d x_in_world [2, 3] at a point in front of the camera.
  [[nodiscard]] Eigen::Matrix<double, 2, 3> project_jacobian(const Eigen::Vector3d& x_in_world) const;

  // Undistorted direction (z = 1) in camera coordinates of a pixel; the inverse of project_from_camera.
  [[nodiscard]] Eigen::Vector3d ray_from_pixel(const Eigen::Vector2d& pixel) const;

  // The camera's position, world coordinates.
  [[nodiscard]] Eigen::Vector3d centre_in_world() const;

  // The same view drawn at another image size.
  [[nodiscard]] PinholeCamera resized(int new_width, int new_height) const;
};

// A level camera 1.5 m above the floor y = 0, at (0, 1.5, distance), looking along -Z at a subject who faces it;
// focal length 1.2 x the larger side. A plain viewpoint; users' cameras: calibrate/focal_prior.h.
PinholeCamera default_camera(int width, int height, double distance = 5.5);

// A camera at `camera_centre` that looks at `target`, +Y up in the image. Metres; focal length in pixels.
PinholeCamera look_at_camera(int width, int height, double focal_px, const Eigen::Vector3d& camera_centre,
                             const Eigen::Vector3d& target);

}  // namespace silpose
