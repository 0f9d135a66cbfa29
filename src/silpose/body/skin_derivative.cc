#include "silpose/body/skin_derivative.h"

#include <algorithm>
#include <functional>

#include "silpose/base/check.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "silpose/body/skin_derivative.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace silpose::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Tag = hn::CappedTag<float, AlignedFloats::kLanes>;

// One register of a point's two rows, from column `first` on. A point x that turns about an axis through c by the
// right hand moves by axis x (x - c) = axis x x + shift.
HWY_INLINE void rows_of_point(const SkinDerivative::Part* begin, const SkinDerivative::Part* end,
                              const float* projection, const float* motion, size_t stride, size_t first, float* rows) {
  const Tag d;
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

void rows_of_points(const SkinDerivative::Part* parts, const uint32_t* part_end, const int32_t* blocks,
                    size_t num_points, const float* projections, const float* motion, size_t stride, float* rows) {
  const Tag d;
  const size_t lanes = hn::Lanes(d);
  const SkinDerivative::Part* begin = parts;
  for (size_t p = 0; p < num_points; ++p, rows += 2 * stride, projections += 6) {
    const SkinDerivative::Part* const end = parts + part_end[p];
    for (size_t column = 0; column < stride; column += lanes) {
      if (blocks[p] >> (column / AlignedFloats::kLanes) & 1) {
        rows_of_point(begin, end, projections, motion, stride, column, rows);
      } else {
        hn::Store(hn::Zero(d), d, rows + column);
        hn::Store(hn::Zero(d), d, rows + stride + column);
      }
    }
    begin = end;
  }
}

}  // namespace silpose::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace silpose {

HWY_EXPORT(rows_of_points);

namespace {

// A column for every DOF, so that limbs, whose DOF fit into a block, are each in one: first what moves more, then
// limbs, larger ones first, each into the first block that has room.
std::vector<uint32_t> limb_columns(const Skeleton& skeleton) {
  constexpr size_t kBlock = AlignedFloats::kLanes;
  const auto joints = skeleton.joints();
  std::vector<size_t> num_below(joints.size(), 0);  // DOF of the joint and of those below it
  for (size_t j = joints.size(); j-- > 0;) {
    num_below[j] += joints[j].dof_indices.size();
    if (joints[j].parent_idx >= 0) num_below[static_cast<size_t>(joints[j].parent_idx)] += num_below[j];
  }
  std::vector<size_t> limb(joints.size()), limbs;  // the joint that a limb begins with
  std::vector<uint32_t> columns(skeleton.dofs().size()), used(1, 0);
  for (size_t j = 0; j < joints.size(); ++j) {
    const bool is_trunk = num_below[j] > kBlock;
    const auto parent = static_cast<size_t>(std::max(joints[j].parent_idx, 0));
    limb[j] = j == 0 || num_below[parent] > kBlock ? j : limb[parent];
    if (!is_trunk && limb[j] == j) limbs.push_back(j);
    for (const int d : joints[j].dof_indices) {
      if (!is_trunk) continue;
      if (used.back() == kBlock) used.push_back(0);
      columns[static_cast<size_t>(d)] = static_cast<uint32_t>((used.size() - 1) * kBlock) + used.back()++;
    }
  }
  std::ranges::stable_sort(limbs, std::greater(), [&](size_t j) { return num_below[j]; });
  for (const size_t first : limbs) {
    size_t block = 0;
    while (block < used.size() && used[block] + num_below[first] > kBlock) ++block;
    if (block == used.size()) used.push_back(0);
    for (size_t j = first; j < joints.size(); ++j) {
      if (limb[j] != first) continue;
      for (const int d : joints[j].dof_indices) {
        columns[static_cast<size_t>(d)] = static_cast<uint32_t>(block * kBlock) + used[block]++;
      }
    }
  }
  return columns;
}

}  // namespace

SkinDerivative::SkinDerivative(const BodyModel& body)
    : body_(&body),
      columns_(limb_columns(body.skeleton)),
      stride_(AlignedFloats::padded(*std::ranges::max_element(columns_) + 1)),
      origin_(Eigen::Vector4f::Zero()),
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
  check(stride_ < 32 * AlignedFloats::kLanes, "SkinDerivative: {} DOF", columns_.size());
  std::vector<int32_t> joint_blocks(joints.size(), 0);
  for (const MovedBy& moved : moved_by_) {
    joint_blocks[moved.joint_idx] |= 1 << (columns_[moved.dof_idx] / AlignedFloats::kLanes);
  }
  for (size_t v = 0; v < body.rest.vertices.size(); ++v) {
    int32_t& blocks = vertex_blocks_.emplace_back(0);
    for (uint32_t i = entry_start_[v]; i < entry_start_[v + 1]; ++i) blocks |= joint_blocks[entries_[i].joint_idx];
  }
}

void SkinDerivative::set_pose(std::span<const double> pose, std::span<const Rigid3> world_from_joint,
                              const Rigid3& frame_from_world) {
  const Skeleton& skeleton = body_->skeleton;
  const Eigen::Matrix3Xd axes = skeleton.dof_axes(pose, world_from_joint);
  const Eigen::Vector3d origin = frame_from_world * world_from_joint[0].translation;
  const Rigid3 origin_from_world = {frame_from_world.rotation, frame_from_world.translation - origin};
  origin_.head<3>() = origin.cast<float>();
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
    float* const column = motion_.data() + moved.joint_idx * 6 * stride_ + columns_[moved.dof_idx];
    for (size_t k = 0; k < 6; ++k) column[k * stride_] = turn_and_shift_[moved.dof_idx][static_cast<Eigen::Index>(k)];
  }
}

void SkinDerivative::set_points(std::span<const uint32_t> vertices) {
  parts_.clear();
  part_end_.clear();
  point_blocks_.clear();
  positions_.clear();
  for (const uint32_t vertex : vertices) {
    Eigen::Vector4f x = origin_;
    for (uint32_t i = entry_start_[vertex]; i < entry_start_[vertex + 1]; ++i) {
      const Eigen::Matrix4f& matrix = origin_from_rest_[entries_[i].joint_idx];
      const Eigen::Vector4f& rest = entries_[i].weighted_rest;
      const Eigen::Vector4f part =
          (matrix.col(0) * rest[0] + matrix.col(1) * rest[1]) + (matrix.col(2) * rest[2] + matrix.col(3) * rest[3]);
      parts_.push_back({{part[0], part[1], part[2]}, rest[3], entries_[i].joint_idx});
      x += part;
    }
    part_end_.push_back(static_cast<uint32_t>(parts_.size()));
    point_blocks_.push_back(vertex_blocks_[vertex]);
    positions_.emplace_back(x.head<3>());
  }
}

void SkinDerivative::find_rows(std::span<const Eigen::Matrix<float, 2, 3>> projections, float* rows) const {
  check(projections.size() == positions_.size(), "SkinDerivative: {} projections of {} points", projections.size(),
        positions_.size());
  if (projections.empty()) return;
  HWY_DYNAMIC_DISPATCH(rows_of_points)
  (parts_.data(), part_end_.data(), point_blocks_.data(), positions_.size(), projections.data()->data(), motion_.data(),
   stride_, rows);
}

}  // namespace silpose
#endif  // HWY_ONCE
