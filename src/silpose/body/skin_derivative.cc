#include "silpose/body/skin_derivative.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "silpose/body/skin_derivative.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace silpose::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// kVectors registers of a row, from column `first` on: the sum over its wrenches.
template <size_t kVectors>
void add_up(const SkinDerivative::Wrench* begin, const SkinDerivative::Wrench* end, const float* motion, size_t stride,
            size_t first, float* row) {
  const hn::ScalableTag<float> d;
  const size_t lanes = hn::Lanes(d);
  auto a = hn::Zero(d), b = a, c = a;
  const auto add = [&](float value, const float* HWY_RESTRICT by) HWY_ATTR {
    const auto v = hn::Set(d, value);
    a = hn::MulAdd(v, hn::Load(d, by), a);
    if constexpr (kVectors > 1) b = hn::MulAdd(v, hn::Load(d, by + lanes), b);
    if constexpr (kVectors > 2) c = hn::MulAdd(v, hn::Load(d, by + 2 * lanes), c);
  };
  for (const auto* wrench = begin; wrench != end; ++wrench) {
    const float* const of_joint = motion + wrench->joint_idx * 6 * stride + first;
    for (size_t k = 0; k < 3; ++k) add(wrench->moment[k], of_joint + k * stride);
    for (size_t k = 0; k < 3; ++k) add(wrench->force[k], of_joint + (3 + k) * stride);
  }
  hn::Store(a, d, row + first);
  if constexpr (kVectors > 1) hn::Store(b, d, row + first + lanes);
  if constexpr (kVectors > 2) hn::Store(c, d, row + first + 2 * lanes);
}

void rows_of_wrenches(const SkinDerivative::Wrench* wrenches, const uint32_t* sum_end, size_t num_sums,
                      const float* motion, size_t stride, float* rows) {
  const size_t lanes = hn::Lanes(hn::ScalableTag<float>());
  const SkinDerivative::Wrench* begin = wrenches;
  for (size_t s = 0; s < num_sums; ++s, rows += stride) {
    const SkinDerivative::Wrench* const end = wrenches + sum_end[s];
    size_t column = 0;
    for (; column + 3 * lanes <= stride; column += 3 * lanes) add_up<3>(begin, end, motion, stride, column, rows);
    for (; column < stride; column += lanes) add_up<1>(begin, end, motion, stride, column, rows);
    begin = end;
  }
}

}  // namespace silpose::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace silpose {

HWY_EXPORT(rows_of_wrenches);

SkinDerivative::SkinDerivative(const BodyModel& body)
    : body_(&body),
      stride_(AlignedFloats::padded(body.skeleton.dofs().size() + 1)),
      world_from_joint_(body.skeleton.joints().size()),
      origin_(Eigen::Vector3f::Zero()),
      origin_from_rest_(body.skeleton.joints().size()),
      sums_(body.skeleton.joints().size(), Rows::Zero()),
      is_touched_(body.skeleton.joints().size(), 0),
      touched_(body.skeleton.joints().size() + 1) {
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

void SkinDerivative::set_pose(std::span<const double> pose, const Rigid3& frame_from_world) {
  const Skeleton& skeleton = body_->skeleton;
  skeleton.forward_kinematics(pose, world_from_joint_);
  const Eigen::Matrix3Xd axes = skeleton.dof_axes(pose, world_from_joint_);
  const Eigen::Vector3d origin = frame_from_world * world_from_joint_[0].translation;
  const Rigid3 origin_from_world = {frame_from_world.rotation, frame_from_world.translation - origin};
  origin_ = origin.cast<float>();
  for (size_t j = 0; j < world_from_joint_.size(); ++j) {
    const Rigid3 matrix = origin_from_world * (world_from_joint_[j] * body_->joint_from_rest[j]);
    origin_from_rest_[j] << matrix.rotation.transpose().cast<float>(), matrix.translation.transpose().cast<float>();
  }
  for (const MovedBy& moved : moved_by_) {
    const Dof& dof = skeleton.dofs()[moved.dof_idx];
    const Eigen::Vector3d axis = frame_from_world.rotation * axes.col(moved.dof_idx);
    const Eigen::Vector3d centre =
        origin_from_world * world_from_joint_[static_cast<size_t>(dof.joint_idx)].translation;
    // Along a translation g does g . axis; turned about the axis, g at x does axis . ((x - centre) x g).
    const Eigen::Vector3d by_moment = dof.is_translation ? Eigen::Vector3d::Zero() : axis;
    const Eigen::Vector3d by_force = dof.is_translation ? axis : centre.cross(axis);
    float* const column = motion_.data() + moved.joint_idx * 6 * stride_ + moved.dof_idx;
    for (size_t k = 0; k < 3; ++k) {
      column[k * stride_] = static_cast<float>(by_moment[static_cast<Eigen::Index>(k)]);
      column[(3 + k) * stride_] = static_cast<float>(by_force[static_cast<Eigen::Index>(k)]);
    }
  }
  wrenches_.clear();
  sum_end_.clear();
  for (size_t i = 0; i < num_touched_; ++i) {
    sums_[touched_[i]].setZero();
    is_touched_[touched_[i]] = 0;
  }
  num_touched_ = 0;
}

void SkinDerivative::end_sum() {
  for (size_t i = 0; i < num_touched_; ++i) {
    const uint32_t j = touched_[i];
    Rows& sum = sums_[j];
    const Rows& matrix = origin_from_rest_[j];
    // The sum of (A X w) x g.
    const auto turns = [&](int a, int b) {
      return (matrix.col(a).array() * sum.col(b).array() - matrix.col(b).array() * sum.col(a).array()).sum();
    };
    wrenches_.push_back({{turns(1, 2), turns(2, 0), turns(0, 1)}, {sum(3, 0), sum(3, 1), sum(3, 2)}, j});
    sum.setZero();
    is_touched_[j] = 0;
  }
  num_touched_ = 0;
  sum_end_.push_back(static_cast<uint32_t>(wrenches_.size()));
}

void SkinDerivative::take(float* rows) {
  HWY_DYNAMIC_DISPATCH(rows_of_wrenches)
  (wrenches_.data(), sum_end_.data(), sum_end_.size(), motion_.data(), stride_, rows);
  wrenches_.clear();
  sum_end_.clear();
}

}  // namespace silpose
#endif  // HWY_ONCE
