// EndMotion: how the ends of an outline's spans move with the pose, and what that does to the cells they lie in.
// Threads: an object belongs to one thread.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "silpose/base/aligned_floats.h"
#include "silpose/body/skin_derivative.h"
#include "silpose/geometry/camera.h"
#include "silpose/likelihood/coverage_difference.h"
#include "silpose/likelihood/jacobian_kernels.h"
#include "silpose/render/outline_spans.h"

namespace silpose {

// d pixel / d x_in_cam.
class LensDerivative {
 public:
  explicit LensDerivative(const PinholeCamera& camera);
  [[nodiscard]] Eigen::Matrix<float, 2, 3> at(const Eigen::Vector3f& x_in_cam) const {
    if (!straight_) return lens_.project_jacobian(x_in_cam.cast<double>()).cast<float>();
    const float inverse_depth = 1 / x_in_cam.z();
    const float u = fx_ * inverse_depth, v = fy_ * inverse_depth;
    Eigen::Matrix<float, 2, 3> jacobian;
    jacobian << u, 0, -u * x_in_cam.x() * inverse_depth, 0, v, -v * x_in_cam.y() * inverse_depth;
    return jacobian;
  }

 private:
  PinholeCamera lens_;  // at the origin
  bool straight_;
  float fx_, fy_;
};

class EndMotion {
 public:
  explicit EndMotion(const BodyModel& body);  // keeps a reference

  // Where the pose puts the body in the camera's coordinates.
  void set_pose(std::span<const double> pose, std::span<const Rigid3> world_from_joint, const Rigid3& cam_from_world) {
    skin_derivative_.set_pose(pose, world_from_joint, cam_from_world);
  }

  // Where the Jacobian has the derivative by each DOF [D].
  [[nodiscard]] std::span<const uint32_t> columns() const { return skin_derivative_.columns(); }

  // Fills the Jacobian of a difference to which the ends of `spans` were added. `vertex_of_slot`: the mesh's vertices
  // by the outline's; `by`: how much an end that moves by a pixel changes the coverage of its cell.
  void fill_jacobian(const OutlineSpans& spans, std::span<const uint32_t> vertex_of_slot, const LensDerivative& lens,
                     float by, CoverageDifference& difference);

 private:
  static constexpr uint32_t kNone = 0xffffffff;

  SkinDerivative skin_derivative_;
  std::vector<EndRow> ends_;
  // Vertices that ends lie between, each once.
  std::vector<uint32_t> point_of_slot_;  // kNone for most
  std::vector<uint32_t> slots_, vertices_;
  std::vector<Eigen::Matrix<float, 2, 3>> projections_;
  AlignedFloats point_rows_;
};

}  // namespace silpose
