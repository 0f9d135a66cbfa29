// SkinDerivative: how vertices of a skinned mesh move with the pose, along given directions: rows d (sum of g . x) /
// d pose. With x = sum_j w_j A_j X (A_j = where the pose puts joint j's part of the rest mesh) a sum over vertices is
// known by sum of g (w_j X, w_j)' for each joint: its force and its moment there, and a row is six numbers a joint
// times what a turn or shift of each DOF above the joint does to them. Threads: one thread per object.
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

  // Takes a pose [D] and forgets all sums. Positions and directions are in the coordinates of `frame`.
  void set_pose(std::span<const double> pose, const Rigid3& frame_from_world = {});

  [[nodiscard]] Eigen::Vector3f position(uint32_t vertex) const;

  // Adds the vertex, seen along `direction` (any length), to the sum at hand.
  void add(uint32_t vertex, const Eigen::Vector3f& direction);
  // The sum at hand is complete, the next begins.
  void end_sum();

  [[nodiscard]] size_t num_sums() const { return sum_end_.size(); }

  // What a row takes: D and at least one more, which is zero.
  [[nodiscard]] size_t row_stride() const { return stride_; }

  // rows [sums, row_stride()], aligned as AlignedFloats: d sum / d pose; then zeros. Forgets all sums.
  void take(float* rows);

  // What take() computes from: the force and moment of a sum at a joint, about origin_.
  struct Wrench {
    float moment[3], force[3];
    uint32_t joint_idx;
  };

 private:
  using Rows = Eigen::Matrix<float, 4, 3>;  // three rows of four numbers, each contiguous
  struct Entry {
    Eigen::Vector4f weighted_rest;  // w X, w
    uint32_t joint_idx;
  };
  struct MovedBy {
    uint32_t joint_idx, dof_idx;
  };

  const BodyModel* body_;
  size_t stride_;
  std::vector<uint32_t> entry_start_;     // [V + 1]
  std::vector<Entry> entries_;            // a vertex and a joint that moves it
  std::vector<MovedBy> moved_by_;         // every joint with every DOF above it
  std::vector<Rigid3> world_from_joint_;  // [J]
  Eigen::Vector3f origin_;                // near the body, so that moments about it stay exact
  std::vector<Rows> origin_from_rest_;    // [J]
  AlignedFloats motion_;                  // [J, 6, stride] by moment x y z, by force x y z; zero for other DOF
  std::vector<Rows> sums_;                // [J] of the sum at hand
  std::vector<uint8_t> is_touched_;       // [J]
  std::vector<uint32_t> touched_;         // [J + 1] joints of the sum at hand
  size_t num_touched_ = 0;
  std::vector<Wrench> wrenches_;
  std::vector<uint32_t> sum_end_;  // in wrenches_
};

inline Eigen::Vector3f SkinDerivative::position(uint32_t vertex) const {
  Eigen::Array4f x = Eigen::Array4f::Zero(), y = x, z = x;
  for (uint32_t i = entry_start_[vertex]; i < entry_start_[vertex + 1]; ++i) {
    const Entry& entry = entries_[i];
    const Rows& matrix = origin_from_rest_[entry.joint_idx];
    x += matrix.col(0).array() * entry.weighted_rest.array();
    y += matrix.col(1).array() * entry.weighted_rest.array();
    z += matrix.col(2).array() * entry.weighted_rest.array();
  }
  return Eigen::Vector3f(x.sum(), y.sum(), z.sum()) + origin_;
}

inline void SkinDerivative::add(uint32_t vertex, const Eigen::Vector3f& direction) {
  for (uint32_t i = entry_start_[vertex]; i < entry_start_[vertex + 1]; ++i) {
    const Entry& entry = entries_[i];
    const uint32_t j = entry.joint_idx;
    Rows& sum = sums_[j];
    sum.col(0) += direction.x() * entry.weighted_rest;
    sum.col(1) += direction.y() * entry.weighted_rest;
    sum.col(2) += direction.z() * entry.weighted_rest;
    touched_[num_touched_] = j;
    num_touched_ += static_cast<size_t>(1 - is_touched_[j]);
    is_touched_[j] = 1;
  }
}

}  // namespace silpose
