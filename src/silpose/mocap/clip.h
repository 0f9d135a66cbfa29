// Clip: recorded motion of any skeleton, as a motion-capture file holds it: joints, their rest offsets, and for each
// frame where each joint is in its parent. Lengths are in the file's own unit, which BVH does not specify; retargeting
// finds the scale.
// Threads: a value; const functions are safe.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "silpose/geometry/rigid3.h"

namespace silpose {

struct Clip {
  struct Joint {
    std::string name;                                  // an end site's is its parent's with "_end"
    int parent_idx = -1;                               // -1: a root; always < own index
    Eigen::Vector3d offset = Eigen::Vector3d::Zero();  // in the parent, rest pose, file units
    bool is_end = false;                               // an end site: has no children and never turns
  };

  std::string name;           // of the file, for messages
  std::vector<Joint> joints;  // [J]
  double fps = 30;
  // Row-major [T, J]: the joint's coordinate frame in its parent's (a root's: in the world).
  std::vector<Eigen::Quaterniond> rotations;  // unit
  std::vector<Eigen::Vector3d> translations;  // file units; mostly the joint's offset

  [[nodiscard]] size_t num_joints() const { return joints.size(); }
  [[nodiscard]] size_t num_frames() const { return joints.empty() ? 0 : rotations.size() / joints.size(); }
  [[nodiscard]] double duration_s() const { return static_cast<double>(num_frames()) / fps; }
  [[nodiscard]] std::optional<int> find_joint(std::string_view joint_name) const;
  [[nodiscard]] std::vector<std::string> joint_names() const;  // [J]

  // Each joint's coordinate frame in the world [J], file units.
  // Errors: throws std::invalid_argument when there is no such frame, or [T, J] values do not fit the joints.
  [[nodiscard]] std::vector<Rigid3> world_from_joint(size_t frame) const;

  // Joint positions in the world [J], file units.
  [[nodiscard]] std::vector<Eigen::Vector3d> forward_kinematics(size_t frame) const;

  // Joint positions in the rest pose [J]: all rotations none, every joint at its offset.
  [[nodiscard]] std::vector<Eigen::Vector3d> rest_positions() const;
};

}  // namespace silpose
