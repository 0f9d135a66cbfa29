#include "silpose/body/skeleton.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "silpose/base/check.h"

namespace silpose {
namespace {

// rotation := rotation * (turn by `radians` about coordinate axis `k`): mixes the two other columns.
void turn_cardinal(Eigen::Matrix3d& rotation, int k, double radians) {
  const double c = std::cos(radians), s = std::sin(radians);
  const int a = (k + 1) % 3, b = (k + 2) % 3;
  const Eigen::Vector3d u = rotation.col(a), v = rotation.col(b);
  rotation.col(a) = c * u + s * v;
  rotation.col(b) = c * v - s * u;
}

void turn(Eigen::Matrix3d& rotation, int cardinal, double sign, const Eigen::Vector3d& axis, double radians) {
  if (cardinal >= 0) {
    turn_cardinal(rotation, cardinal, sign * radians);
  } else {
    rotation *= Eigen::AngleAxisd(radians, axis).toRotationMatrix();
  }
}

}  // namespace

std::string_view without_side(std::string_view name) {
  for (const std::string_view side : {"right_", "left_"}) {
    if (name.starts_with(side)) return name.substr(side.size());
  }
  return name;
}

Skeleton::Skeleton(std::string name, std::vector<Joint> joints, std::vector<Dof> dofs)
    : name_(std::move(name)), joints_(std::move(joints)), dofs_(std::move(dofs)), axis_in_parent_(dofs_.size()) {
  std::vector<int> uses(dofs_.size(), 0);
  step_start_.reserve(joints_.size() + 1);
  for (int j = 0; j < num_joints(); ++j) {
    const Joint& joint = joints_[j];
    check(joint.parent_idx >= -1 && joint.parent_idx < j,
          "skeleton '{}': parent {} of joint {} does not come before it", name_, joint.parent_idx, j);
    check(joint.offset_in_parent.allFinite(), "skeleton '{}': offset of joint '{}' is not finite", name_, joint.name);
    check(joint.parent_from_rest.isUnitary(1e-6) && joint.parent_from_rest.determinant() > 0,
          "skeleton '{}': the rest rotation of joint '{}' is none", name_, joint.name);
    is_rotated_.push_back(joint.parent_from_rest != Eigen::Matrix3d::Identity());
    step_start_.push_back(steps_.size());
    bool rotated = false;
    for (const int d : joint.dof_indices) {
      check(d >= 0 && d < num_dofs() && dofs_[d].joint_idx == j, "skeleton '{}': DOF {} is not of joint '{}'", name_, d,
            joint.name);
      const Dof& dof = dofs_[d];
      check(std::abs(dof.axis.norm() - 1) < 1e-9, "skeleton '{}': axis of '{}' is not a unit vector", name_, dof.name);
      check(dof.lower < dof.upper && std::isfinite(dof.lower) && std::isfinite(dof.upper),
            "skeleton '{}': limits of '{}' are {} to {}", name_, dof.name, dof.lower, dof.upper);
      check(!dof.is_translation || !rotated, "skeleton '{}': translation '{}' comes after a rotation", name_, dof.name);
      rotated = !dof.is_translation;
      ++uses[d];
      axis_in_parent_[d] = is_rotated_.back() ? Eigen::Vector3d(joint.parent_from_rest * dof.axis) : dof.axis;
      Step step{.dof_idx = d, .is_translation = dof.is_translation};
      for (int k = 0; k < 3; ++k) {
        if (std::abs(dof.axis[k]) == 1) step = {d, k, dof.axis[k], dof.is_translation};
      }
      steps_.push_back(step);
    }
  }
  step_start_.push_back(steps_.size());
  for (int d = 0; d < num_dofs(); ++d) {
    check(uses[d] == 1, "skeleton '{}': DOF '{}' is used by {} joints", name_, dofs_[d].name, uses[d]);
  }
}

std::optional<int> Skeleton::find_joint(std::string_view name) const {
  for (int j = 0; j < num_joints(); ++j) {
    if (joints_[j].name == name) return j;
  }
  return std::nullopt;
}

std::optional<int> Skeleton::find_dof(std::string_view name_or_column) const {
  for (int d = 0; d < num_dofs(); ++d) {
    if (dofs_[d].name == name_or_column || dofs_[d].column() == name_or_column) return d;
  }
  return std::nullopt;
}

bool Skeleton::is_below(int joint_idx, int ancestor_idx) const {
  check(joint_idx >= 0 && joint_idx < num_joints(), "is_below: no joint {}", joint_idx);
  while (joint_idx > ancestor_idx) joint_idx = joints_[joint_idx].parent_idx;
  return joint_idx == ancestor_idx;
}

void Skeleton::forward_kinematics(std::span<const double> pose, std::span<Rigid3> world_from_joint) const {
  check(pose.size() == dofs_.size(), "forward_kinematics: pose has {} values, not {}", pose.size(), dofs_.size());
  check(world_from_joint.size() == joints_.size(), "forward_kinematics: {} transforms for {} joints",
        world_from_joint.size(), joints_.size());
  for (size_t j = 0; j < joints_.size(); ++j) {
    const Joint& joint = joints_[j];
    Rigid3& out = world_from_joint[j];
    Eigen::Vector3d offset = joint.offset_in_parent;
    size_t step = step_start_[j];
    for (; step < step_start_[j + 1] && steps_[step].is_translation; ++step) {
      const int d = steps_[step].dof_idx;
      offset += pose[d] * axis_in_parent_[d];
    }
    if (joint.parent_idx >= 0) {
      const Rigid3& parent = world_from_joint[joint.parent_idx];
      out.rotation = parent.rotation;
      out.translation = parent.rotation * offset + parent.translation;
    } else {
      out.rotation.setIdentity();
      out.translation = offset;
    }
    if (is_rotated_[j]) out.rotation *= joint.parent_from_rest;
    for (; step < step_start_[j + 1]; ++step) {
      const Step& s = steps_[step];
      turn(out.rotation, s.cardinal, s.sign, dofs_[s.dof_idx].axis, pose[s.dof_idx]);
    }
  }
}

std::vector<Rigid3> Skeleton::forward_kinematics(std::span<const double> pose) const {
  std::vector<Rigid3> world_from_joint(joints_.size());
  forward_kinematics(pose, world_from_joint);
  return world_from_joint;
}

Eigen::Matrix3Xd Skeleton::dof_axes(std::span<const double> pose, std::span<const Rigid3> world_from_joint) const {
  check(pose.size() == dofs_.size() && world_from_joint.size() == joints_.size(), "dof_axes: {} values, {} transforms",
        pose.size(), world_from_joint.size());
  Eigen::Matrix3Xd axes(3, num_dofs());
  for (size_t j = 0; j < joints_.size(); ++j) {
    const int parent = joints_[j].parent_idx;
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    if (parent >= 0) rotation = world_from_joint[parent].rotation;
    if (is_rotated_[j]) rotation *= joints_[j].parent_from_rest;
    for (size_t step = step_start_[j]; step < step_start_[j + 1]; ++step) {
      const Step& s = steps_[step];
      axes.col(s.dof_idx) = rotation * dofs_[s.dof_idx].axis;
      const bool is_last = step + 1 == step_start_[j + 1];
      if (!s.is_translation && !is_last) turn(rotation, s.cardinal, s.sign, dofs_[s.dof_idx].axis, pose[s.dof_idx]);
    }
  }
  return axes;
}

const Eigen::Vector3d& Skeleton::axis_in_parent(int dof_idx) const {
  check(dof_idx >= 0 && dof_idx < num_dofs(), "axis_in_parent: no DOF {}", dof_idx);
  return axis_in_parent_[dof_idx];
}

void Skeleton::clamp(std::span<double> pose) const {
  check(pose.size() == dofs_.size(), "clamp: pose has {} values, not {}", pose.size(), dofs_.size());
  for (size_t d = 0; d < dofs_.size(); ++d) {
    const Dof& dof = dofs_[d];
    if (dof.has_limits()) {
      pose[d] = std::clamp(pose[d], dof.lower, dof.upper);
    } else if (!dof.is_translation) {
      pose[d] = wrap_angle(pose[d]);
    }
  }
}

std::vector<double> Skeleton::normalise(std::span<const double> pose) const {
  check(pose.size() == dofs_.size(), "normalise: pose has {} values, not {}", pose.size(), dofs_.size());
  std::vector<double> npsu(dofs_.size());
  for (size_t d = 0; d < dofs_.size(); ++d) {
    npsu[d] = (pose[d] - dofs_[d].lower) / (dofs_[d].upper - dofs_[d].lower);
  }
  return npsu;
}

std::vector<double> Skeleton::denormalise(std::span<const double> npsu) const {
  check(npsu.size() == dofs_.size(), "denormalise: {} values, not {}", npsu.size(), dofs_.size());
  std::vector<double> pose(dofs_.size());
  for (size_t d = 0; d < dofs_.size(); ++d) {
    pose[d] = dofs_[d].lower + npsu[d] * (dofs_[d].upper - dofs_[d].lower);
  }
  return pose;
}

}  // namespace silpose
