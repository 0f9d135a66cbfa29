// SkinDerivative: how points of a skinned mesh move with the pose: two rows d (P x) / d pose for each of them, P [2, 3]
// being the derivative by x of its pixel, or of any other projection that the caller gives.
// With x = sum_j w_j A_j X (A_j = where the pose puts joint j's part of the rest mesh), dx is the sum over its joints
// of what a turn or shift of each DOF above the joint does to w_j A_j X. Threads: one thread per object.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "silpose/base/aligned_floats.h"
#include "silpose/body/body_model.h"

namespace silpose {

class SkinDerivative {
 public:
  explicit SkinDerivative(const BodyModel& body);  // keeps a reference

  // Takes a pose [D] and its forward kinematics [J]. Positions are in the coordinates of `frame`.
  void set_pose(std::span<const double> pose, std::span<const Rigid3> world_from_joint,
                const Rigid3& frame_from_world = {});

  // Takes points [P], vertices of the mesh; after set_pose().
  void set_points(std::span<const uint32_t> vertices);

  // Of the points [P].
  [[nodiscard]] std::span<const Eigen::Vector3f> positions() const { return positions_; }

  // Columns of a row come in blocks of AlignedFloats::kLanes, a limb's in one block: where the derivative by each DOF
  // is [D], how many there are, and, one bit per block, where the rows of each point are not zero [P].
  [[nodiscard]] std::span<const uint32_t> columns() const { return columns_; }
  [[nodiscard]] size_t row_stride() const { return stride_; }
  [[nodiscard]] std::span<const int32_t> blocks() const { return point_blocks_; }

  // rows [P, 2, row_stride()], aligned as AlignedFloats: d (projections[p] x_p) / d pose by columns(), the others zero.
  void find_rows(std::span<const Eigen::Matrix<float, 2, 3>> projections, float* rows) const;

  // What find_rows() computes from: a joint's part of a point, about origin_.
  struct Part {
    float weighted_x[3], weight;
    uint32_t joint_idx;
  };

 private:
  struct Entry {
    Eigen::Vector4f weighted_rest;  // w X, w
    uint32_t joint_idx;
  };
  struct MovedBy {
    uint32_t joint_idx, dof_idx;
  };

  const BodyModel* body_;
  std::vector<uint32_t> columns_;  // [D]
  size_t stride_ = 0;
  std::vector<int32_t> vertex_blocks_;                   // [V]
  std::vector<uint32_t> entry_start_;                    // [V + 1]
  std::vector<Entry> entries_;                           // a vertex and a joint that moves it
  std::vector<MovedBy> moved_by_;                        // every joint with every DOF above it
  Eigen::Vector4f origin_;                               // and 0; near the body, so that moments about it stay exact
  std::vector<Eigen::Matrix4f> origin_from_rest_;        // [J]
  std::vector<Eigen::Vector<float, 6>> turn_and_shift_;  // [D]
  AlignedFloats motion_;                                 // [J, 6, stride] turns x y z, shifts x y z; zero for other DOF
  std::vector<Part> parts_;                              // of the points, one after another
  std::vector<uint32_t> part_end_;                       // [P]
  std::vector<int32_t> point_blocks_;                    // [P]
  std::vector<Eigen::Vector3f> positions_;               // [P]
};

}  // namespace silpose
