// Images of a printed board, ray by ray through a camera with distortion: the ground truth of calibration tests.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "silpose/base/rng.h"
#include "silpose/calibrate/board.h"
#include "silpose/geometry/camera.h"
#include "silpose/geometry/rigid3.h"

namespace silpose {

class BoardFilm {
 public:
  explicit BoardFilm(PinholeCamera camera, double noise = 2) : camera_(std::move(camera)), noise_(noise) {
    for (int y = 0; y < camera_.height; ++y) {
      for (int x = 0; x < camera_.width; ++x) {
        for (int s = 0; s < kSamples; ++s) {
          rays_.push_back(camera_.ray_from_pixel({x + 0.25 + 0.5 * (s % 2), y + 0.25 + 0.5 * (s / 2)}));
        }
      }
    }
  }

  // The board in front of a grey wall. The square between its first four corners is dark, its margin a square wide.
  [[nodiscard]] ByteImage image(const Board& board, const Rigid3& world_from_board, Rng& rng) const {
    const Rigid3 board_from_cam = (camera_.cam_from_world * world_from_board).inverse();
    ByteImage image(camera_.width, camera_.height, 3);
    size_t ray = 0;
    for (int y = 0; y < camera_.height; ++y) {
      for (int x = 0; x < camera_.width; ++x) {
        double sum = 0;
        for (int s = 0; s < kSamples; ++s) sum += brightness(board, board_from_cam, rays_[ray++]);
        const double grey = std::clamp(sum / kSamples + noise_ * rng.normal(), 0.0, 255.0);
        for (int c = 0; c < 3; ++c) image.at(x, y, c) = static_cast<uint8_t>(grey);
      }
    }
    return image;
  }

  [[nodiscard]] const PinholeCamera& camera() const { return camera_; }

 private:
  static constexpr int kSamples = 4;  // per pixel

  static double brightness(const Board& board, const Rigid3& board_from_cam, const Eigen::Vector3d& ray) {
    static constexpr double kWall = 120, kPaper = 215, kInk = 35;
    const Eigen::Vector3d along = board_from_cam.rotation * ray, camera_centre = board_from_cam.translation;
    const double depth = -camera_centre.z() / along.z();
    if (!(depth > 0)) return kWall;
    const Eigen::Vector3d point = (camera_centre + depth * along) / board.square_m;
    const double x = point.x(), y = point.y();
    if (x < -2 || y < -2 || x > board.columns + 1 || y > board.rows + 1) return kWall;
    if (x < -1 || y < -1 || x > board.columns || y > board.rows) return kPaper;
    return (static_cast<int>(std::floor(x)) + static_cast<int>(std::floor(y))) % 2 == 0 ? kInk : kPaper;
  }

  PinholeCamera camera_;
  double noise_;                       // grey levels
  std::vector<Eigen::Vector3d> rays_;  // kSamples a pixel, in the camera's frame
};

// The board with its middle at `middle` (world), its print towards `camera_centre`, turned there by three angles
// (radians): about its rows, its columns, and in its plane.
inline Rigid3 board_towards(const Board& board, const Eigen::Vector3d& middle, const Eigen::Vector3d& camera_centre,
                            const Eigen::Vector3d& turn) {
  Eigen::Matrix3d facing;  // columns: the board's x, y, z, the first seen level
  facing.col(2) = (middle - camera_centre).normalized();
  facing.col(0) = facing.col(2).cross(Eigen::Vector3d::UnitY()).normalized();
  facing.col(1) = facing.col(2).cross(facing.col(0));
  Rigid3 pose;
  pose.rotation = facing * (Eigen::AngleAxisd(turn.x(), Eigen::Vector3d::UnitX()) *
                            Eigen::AngleAxisd(turn.y(), Eigen::Vector3d::UnitY()) *
                            Eigen::AngleAxisd(turn.z(), Eigen::Vector3d::UnitZ()))
                               .toRotationMatrix();
  const Eigen::Vector3d half(board.square_m * (board.columns - 1) / 2, board.square_m * (board.rows - 1) / 2, 0);
  pose.translation = middle - pose.rotation * half;
  return pose;
}

// The board on the floor y = 0, print up, its middle at (x, 0, z), rows along X.
inline Rigid3 board_on_floor(const Board& board, double x, double z) {
  return board_towards(board, {x, 0, z}, {x, 1, z + 1e-9}, Eigen::Vector3d::Zero());
}

}  // namespace silpose
