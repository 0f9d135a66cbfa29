// The skeleton of the thesis. Signs, orders and the sources of the limits are explained in docs/formats.md.
#include <algorithm>
#include <array>

#include "silpose/base/check.h"
#include "silpose/human/human.h"

namespace silpose {
namespace {

struct JointRow {
  const char* name;
  int parent_idx;
};

constexpr std::array<JointRow, 20> kJoints = {{
    {"root", -1},          {"abdomen", 0},          {"thorax", 1},         {"head", 2},
    {"right_hip", 0},      {"right_thigh", 4},      {"right_shin", 5},     {"right_foot", 6},
    {"left_hip", 0},       {"left_thigh", 8},       {"left_shin", 9},      {"left_foot", 10},
    {"right_shoulder", 2}, {"right_upper_arm", 12}, {"right_forearm", 13}, {"right_hand", 14},
    {"left_shoulder", 2},  {"left_upper_arm", 16},  {"left_forearm", 17},  {"left_hand", 18},
}};

struct DofRow {
  const char* suffix;
  double x, y, z;               // axis
  double lower_deg, upper_deg;  // metres for translations
};

// Of a joint: its DOF in column order, and the order (indices into it) in which they are applied, outermost first.
struct MotionRow {
  const char* joint;  // of a limb without its side; the axes are the right side's
  std::vector<DofRow> dofs;
  std::vector<int> order;
};

const std::vector<MotionRow>& trunk_motion() {
  static const std::vector<MotionRow> rows = {
      {"root",
       {{"tx", 1, 0, 0, -10, 10},
        {"ty", 0, 1, 0, 0, 3},
        {"tz", 0, 0, 1, -10, 10},
        {"rx", 1, 0, 0, -180, 180},
        {"ry", 0, 1, 0, -180, 180},
        {"rz", 0, 0, 1, -180, 180}},
       {0, 1, 2, 4, 3, 5}},
      {"abdomen", {{"rx", 1, 0, 0, -35, 60}}, {0}},
      {"thorax", {{"rx", 1, 0, 0, -25, 45}, {"ry", 0, 1, 0, -45, 45}, {"rz", 0, 0, 1, -40, 40}}, {0, 2, 1}},
      {"head", {{"rx", 1, 0, 0, -60, 50}, {"ry", 0, 1, 0, -80, 80}, {"rz", 0, 0, 1, -45, 45}}, {0, 2, 1}},
  };
  return rows;
}

const std::vector<MotionRow>& leg_motion() {
  static const std::vector<MotionRow> rows = {
      {"thigh", {{"rx", -1, 0, 0, -30, 140}, {"ry", 0, 1, 0, -45, 45}, {"rz", 0, 0, -1, -30, 45}}, {0, 2, 1}},
      {"shin", {{"rx", 1, 0, 0, -10, 150}}, {0}},
      {"foot", {{"rx", -1, 0, 0, -50, 30}}, {0}},
  };
  return rows;
}

const std::vector<MotionRow>& arm_motion() {
  static const std::vector<MotionRow> rows = {
      {"upper_arm", {{"rx", -1, 0, 0, -60, 180}, {"ry", 0, 1, 0, -90, 95}, {"rz", 0, 0, -1, -45, 180}}, {2, 0, 1}},
      {"forearm", {{"rx", -1, 0, 0, -10, 150}, {"ry", 0, 1, 0, -80, 80}}, {0, 1}},
      // Palms face the thighs: the wrist flexes about the forward axis.
      {"hand", {{"rx", 0, 0, 1, -70, 80}, {"rz", -1, 0, 0, -30, 20}}, {0, 1}},
  };
  return rows;
}

void add_motion(const std::vector<MotionRow>& rows, const std::string& side, std::vector<Joint>& joints,
                std::vector<Dof>& dofs) {
  for (const MotionRow& row : rows) {
    const std::string name = side + row.joint;
    int joint_idx = 0;
    while (joints[joint_idx].name != name) ++joint_idx;
    const int first = static_cast<int>(dofs.size());
    for (const DofRow& dof : row.dofs) {
      const bool is_translation = dof.suffix[0] == 't';
      const double unit = is_translation ? 1 : to_radians(1);
      // The mirror image of a turn about (x, y, z) is one about (x, -y, -z).
      const double mirror = side == "left_" ? -1 : 1;
      dofs.push_back({.name = name + "_" + dof.suffix,
                      .joint_idx = joint_idx,
                      .is_translation = is_translation,
                      .is_periodic = dof.upper_deg - dof.lower_deg == 360,
                      .axis = {dof.x, mirror * dof.y, mirror * dof.z},
                      .lower = unit * dof.lower_deg,
                      .upper = unit * dof.upper_deg});
    }
    for (const int i : row.order) joints[joint_idx].dof_indices.push_back(first + i);
  }
}

}  // namespace

Skeleton human_skeleton(std::span<const Eigen::Vector3d> joint_in_world) {
  check(joint_in_world.size() == kJoints.size(), "human_skeleton: {} joint positions, not {}", joint_in_world.size(),
        kJoints.size());
  std::vector<Joint> joints;
  for (size_t j = 0; j < kJoints.size(); ++j) {
    const int parent = kJoints[j].parent_idx;
    Joint joint{.name = kJoints[j].name, .parent_idx = parent};
    // The root has no offset: its translation is where the pelvis is in the world.
    if (parent >= 0) joint.offset_in_parent = joint_in_world[j] - joint_in_world[parent];
    joints.push_back(std::move(joint));
  }
  std::vector<Dof> dofs;
  add_motion(trunk_motion(), "", joints, dofs);
  add_motion(leg_motion(), "right_", joints, dofs);
  add_motion(leg_motion(), "left_", joints, dofs);
  add_motion(arm_motion(), "right_", joints, dofs);
  add_motion(arm_motion(), "left_", joints, dofs);
  return Skeleton("human", std::move(joints), std::move(dofs));
}

}  // namespace silpose
