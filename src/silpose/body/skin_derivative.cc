#include "silpose/body/skin_derivative.h"

#include <algorithm>

#include "silpose/base/check.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "silpose/body/skin_derivative.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace silpose::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// One register of a point's two rows, from column `first` on. A point x that turns about an axis through c by the
// right hand moves by axis x (x - c) = axis x x + shift.
void rows_of_point(const SkinDerivative::Part* begin, const SkinDerivative::Part* end, const float* projection,
                   const float* motion, size_t stride, size_t first, float* rows) {
  const hn::ScalableTag<float> d;
  auto x = hn::Zero(d), y = x, z = x;
  for (const auto* part = begin; part != end; ++part) {
    const float* const of_joint = motion + part->joint_idx * 6 * stride + first;
    const auto turn_x = hn::Load(d, of_joint), turn_y = hn::Load(d, of_joint + stride),
               turn_z = hn::Load(d, of_joint + 2 * stride);
    const auto weight = hn::Set(d, part->weight);
    const auto at_x = hn::Set(d, part->weighted_x[0]), at_y = hn::Set(d, part->weighted_x[1]),
               at_z = hn::Set(d, part->weighted_x[2]);
    x = hn::MulAdd(weight, hn::Load(d, of_joint + 3 * stride), x);
    y = hn::MulAdd(weight, hn::Load(d, of_joint + 4 * stride), y);
    z = hn::MulAdd(weight, hn::Load(d, of_joint + 5 * stride), z);
    x = hn::NegMulAdd(turn_z, at_y, hn::MulAdd(turn_y, at_z, x));
    y = hn::NegMulAdd(turn_x, at_z, hn::MulAdd(turn_z, at_x, y));
    z = hn::NegMulAdd(turn_y, at_x, hn::MulAdd(turn_x, at_y, z));
  }
  for (size_t row = 0; row < 2; ++row) {  // columns of the projection are contiguous
    auto sum = hn::Mul(hn::Set(d, projection[row]), x);
    sum = hn::MulAdd(hn::Set(d, projection[2 + row]), y, sum);
    sum = hn::MulAdd(hn::Set(d, projection[4 + row]), z, sum);
    hn::Store(sum, d, rows + row * stride + first);
  }
}

void rows_of_points(const SkinDerivative::Part* parts, const uint32_t* part_end, size_t num_points,
                    const float* projections, const float* motion, size_t stride, float* rows) {
  const size_t lanes = hn::Lanes(hn::ScalableTag<float>());
  const SkinDerivative::Part* begin = parts;
  for (size_t p = 0; p < num_points; ++p, rows += 2 * stride, projections += 6) {
    const SkinDerivative::Part* const end = parts + part_end[p];
    size_t column = 0;
    for (; column < stride; column += lanes) rows_of_point(begin, end, projections, motion, stride, column, rows);
    begin = end;
  }
}

}  // namespace silpose::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace silpose {

HWY_EXPORT(rows_of_points);

SkinDerivative::SkinDerivative(const BodyModel& body)
    : body_(&body),
      stride_(AlignedFloats::padded(body.skeleton.dofs().size() + 1)),
      origin_(Eigen::Vector3f::Zero()),
      origin_from_rest_(body.skeleton.joints().size(), Eigen::Matrix4f::Zero()),
      turn_and_shift_(body.skeleton.dofs().size()) {
  const SkinWeights& skin = body.skin;
  entry_start_ = skin.row_start;
  for (size_t v = 0; v < body.rest.vertices.size(); ++v) {
    for (uint32_t i = skin.row_start[v]; i < skin.row_start[v + 1]; ++i) {
      entries_.push_back({skin.weight[i] * body.rest.vertices[v].homogeneous(), skin.joint_idx[i]});
    }
  }
  const auto joints = body.skeleton.joints();
  for (size_t j = 0; j < joints.size(); ++j) {
    for (int above = static_cast<int>(j); above >= 0; above = joints[static_cast<size_t>(above)].parent_idx) {
      for (const int d : joints[static_cast<size_t>(above)].dof_indices) {
        moved_by_.push_back({static_cast<uint32_t>(j), static_cast<uint32_t>(d)});
      }
    }
  }
  motion_.resize(joints.size() * 6 * stride_);
}

void SkinDerivative::set_pose(std::span<const double> pose, std::span<const Rigid3> world_from_joint,
                              const Rigid3& frame_from_world) {
  const Skeleton& skeleton = body_->skeleton;
  const Eigen::Matrix3Xd axes = skeleton.dof_axes(pose, world_from_joint);
  const Eigen::Vector3d origin = frame_from_world * world_from_joint[0].translation;
  const Rigid3 origin_from_world = {frame_from_world.rotation, frame_from_world.translation - origin};
  origin_ = origin.cast<float>();
  for (size_t j = 0; j < world_from_joint.size(); ++j) {
    const Rigid3 matrix = origin_from_world * (world_from_joint[j] * body_->joint_from_rest[j]);
    origin_from_rest_[j].topRows<3>() << matrix.rotation.cast<float>(), matrix.translation.cast<float>();
  }
  for (size_t d = 0; d < turn_and_shift_.size(); ++d) {
    const Dof& dof = skeleton.dofs()[d];
    const Eigen::Vector3d axis = frame_from_world.rotation * axes.col(static_cast<Eigen::Index>(d));
    if (dof.is_translation) {
      turn_and_shift_[d] << Eigen::Vector3f::Zero(), axis.cast<float>();
    } else {
      const Eigen::Vector3d centre =
          origin_from_world * world_from_joint[static_cast<size_t>(dof.joint_idx)].translation;
      turn_and_shift_[d] << axis.cast<float>(), centre.cross(axis).cast<float>();
    }
  }
  for (const MovedBy& moved : moved_by_) {
    float* const column = motion_.data() + moved.joint_idx * 6 * stride_ + moved.dof_idx;
    for (size_t k = 0; k < 6; ++k) column[k * stride_] = turn_and_shift_[moved.dof_idx][static_cast<Eigen::Index>(k)];
  }
}

void SkinDerivative::set_points(std::span<const uint32_t> vertices) {
  parts_.clear();
  part_end_.clear();
  positions_.clear();
  for (const uint32_t vertex : vertices) {
    Eigen::Vector4f x(origin_.x(), origin_.y(), origin_.z(), 0);
    for (uint32_t i = entry_start_[vertex]; i < entry_start_[vertex + 1]; ++i) {
      const Eigen::Matrix4f& matrix = origin_from_rest_[entries_[i].joint_idx];
      const Eigen::Vector4f& rest = entries_[i].weighted_rest;
      const Eigen::Vector4f part =
          (matrix.col(0) * rest[0] + matrix.col(1) * rest[1]) + (matrix.col(2) * rest[2] + matrix.col(3) * rest[3]);
      parts_.push_back({{part[0], part[1], part[2]}, rest[3], entries_[i].joint_idx});
      x += part;
    }
    part_end_.push_back(static_cast<uint32_t>(parts_.size()));
    positions_.emplace_back(x.head<3>());
  }
}

void SkinDerivative::find_rows(std::span<const Eigen::Matrix<float, 2, 3>> projections, float* rows) const {
  check(projections.size() == positions_.size(), "SkinDerivative: {} projections of {} points", projections.size(),
        positions_.size());
  if (projections.empty()) return;
  HWY_DYNAMIC_DISPATCH(rows_of_points)
  (parts_.data(), part_end_.data(), positions_.size(), projections.data()->data(), motion_.data(), stride_, rows);
}

}  // namespace silpose
#endif  // HWY_ONCE
