// Skeleton: joints, their degrees of freedom and limits; poses in natural units and normalised (NPSU).
// A pose is a vector of D numbers, metres and radians, in DOF order. Zero of every angle is anatomical: standing
// upright, facing +Z, left at +X, arms hanging, palms to the thighs. Equal values left and right are mirror-symmetric.
// Source: thesis Table 2.1 (references.bib: cormier2019); signs, rotation orders and limits: docs/formats.md.
// Threads: a value; const functions are safe.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/geometry/rigid3.h"

namespace silpose {

// One degree of freedom: a translation along, or a rotation about, `axis`: a unit vector in the joint's own frame.
// Joint::dof_indices gives the order in which a joint's rotations are applied. Translations come before (outside) all
// rotations of their joint: those of a root without offset are its world position.
struct Dof {
  std::string name;  // column without its unit: "right_thigh_rx", "root_tx"
  int joint_idx = 0;
  bool is_translation = false;
  bool is_periodic = false;                         // a full turn: limits are for NPSU only, values wrap
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();  // positive values turn by the right hand about it
  double lower = 0, upper = 0;                      // radians or metres
  bool is_shape = false;    // a property of the body, the same in every pose of a clip (stretchable.h)
  bool is_bounded = false;  // a translation that stays within its limits; without it they are for NPSU only

  // Whether poses are kept within the limits.
  [[nodiscard]] bool has_limits() const { return is_translation ? is_bounded : !is_periodic; }
  [[nodiscard]] std::string column() const { return name + (is_translation ? "_m" : "_deg"); }
};

// A name without its leading right_ or left_.
[[nodiscard]] std::string_view without_side(std::string_view name);

struct Joint {
  std::string name;
  int parent_idx = -1;                                         // -1: the root; always < own index
  Eigen::Vector3d offset_in_parent = Eigen::Vector3d::Zero();  // metres, in the zero pose
  std::vector<int> dof_indices = {};                           // rotations in order of application, outermost first
  // Rotation of the joint's own axes in its parent's, in the zero pose: of a root, in the world's. Imported rigs keep
  // their axes by it; the human's are the world's.
  Eigen::Matrix3d parent_from_rest = Eigen::Matrix3d::Identity();
};

class Skeleton {
 public:
  // Errors: throws std::invalid_argument unless parents come first, limits are ordered, DOF refer to joints and rest
  // rotations are rotations.
  Skeleton(std::string name, std::vector<Joint> joints, std::vector<Dof> dofs);

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] std::span<const Joint> joints() const { return joints_; }
  [[nodiscard]] std::span<const Dof> dofs() const { return dofs_; }
  [[nodiscard]] int num_joints() const { return static_cast<int>(joints_.size()); }
  [[nodiscard]] int num_dofs() const { return static_cast<int>(dofs_.size()); }
  [[nodiscard]] std::optional<int> find_joint(std::string_view name) const;
  [[nodiscard]] std::optional<int> find_dof(std::string_view name_or_column) const;
  // True when `joint_idx` is `ancestor_idx` or hangs below it.
  [[nodiscard]] bool is_below(int joint_idx, int ancestor_idx) const;

  // [J] where each joint's coordinate frame is for a pose [D].
  void forward_kinematics(std::span<const double> pose, std::span<Rigid3> world_from_joint) const;
  [[nodiscard]] std::vector<Rigid3> forward_kinematics(std::span<const double> pose) const;

  // The axis of every DOF in world coordinates [3, D]: what a translation moves along, what a rotation turns about
  // (through the joint's centre). `world_from_joint` [J] comes from forward_kinematics.
  [[nodiscard]] Eigen::Matrix3Xd dof_axes(std::span<const double> pose, std::span<const Rigid3> world_from_joint) const;

  // The axis of a DOF in the parent's frame, before the joint's own rotations: of a root's translation, in the world.
  [[nodiscard]] const Eigen::Vector3d& axis_in_parent(int dof_idx) const;

  // Brings a pose inside the limits: clamps, and wraps periodic DOF. Translations that are not bounded are left alone.
  void clamp(std::span<double> pose) const;

  // Natural units to NPSU (0 at the lower limit, 1 at the upper) and back, linear everywhere: nothing is clamped or
  // wrapped. [D]
  [[nodiscard]] std::vector<double> normalise(std::span<const double> pose) const;
  [[nodiscard]] std::vector<double> denormalise(std::span<const double> npsu) const;

 private:
  // What forward kinematics does, step by step: one entry per DOF in order of application, joints in index order.
  struct Step {
    int dof_idx = 0;
    int cardinal = -1;  // 0, 1, 2: the axis is +-x, +-y, +-z; -1: any other
    double sign = 1;    // of a cardinal axis
    bool is_translation = false;
  };

  std::string name_;
  std::vector<Joint> joints_;
  std::vector<Dof> dofs_;
  std::vector<Step> steps_;
  std::vector<size_t> step_start_;               // [J + 1] steps of joint j: step_start_[j] to step_start_[j + 1]
  std::vector<bool> is_rotated_;                 // [J] parent_from_rest is not the identity, whose product is skipped
  std::vector<Eigen::Vector3d> axis_in_parent_;  // [D]
};

// Indices of the DOF for which `predicate(const Dof&)` holds, ascending.
template <class Predicate>
[[nodiscard]] std::vector<int> find_dofs(const Skeleton& skeleton, const Predicate& predicate) {
  std::vector<int> indices;
  for (int d = 0; d < skeleton.num_dofs(); ++d) {
    if (predicate(skeleton.dofs()[static_cast<size_t>(d)])) indices.push_back(d);
  }
  return indices;
}

}  // namespace silpose
