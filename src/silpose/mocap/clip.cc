#include "silpose/mocap/clip.h"

#include "silpose/base/check.h"

namespace silpose {

std::optional<int> Clip::find_joint(std::string_view joint_name) const {
  for (size_t j = 0; j < joints.size(); ++j) {
    if (joints[j].name == joint_name) return static_cast<int>(j);
  }
  return std::nullopt;
}

std::vector<std::string> Clip::joint_names() const {
  std::vector<std::string> names;
  names.reserve(joints.size());
  for (const Joint& joint : joints) names.push_back(joint.name);
  return names;
}

std::vector<Rigid3> Clip::world_from_joint(size_t frame) const {
  check(rotations.size() == num_frames() * num_joints() && translations.size() == rotations.size(),
        "clip '{}': {} rotations and {} translations for {} joints", name, rotations.size(), translations.size(),
        num_joints());
  check(frame < num_frames(), "clip '{}': frame {} of {}", name, frame, num_frames());
  std::vector<Rigid3> world_from_joint(num_joints());
  for (size_t j = 0; j < num_joints(); ++j) {
    const int parent = joints[j].parent_idx;
    check(parent >= -1 && parent < static_cast<int>(j), "clip '{}': parent {} of joint {} does not come before it",
          name, parent, j);
    const size_t at = frame * num_joints() + j;
    const Rigid3 parent_from_joint{rotations[at].toRotationMatrix(), translations[at]};
    world_from_joint[j] =
        parent < 0 ? parent_from_joint : world_from_joint[static_cast<size_t>(parent)] * parent_from_joint;
  }
  return world_from_joint;
}

std::vector<Eigen::Vector3d> Clip::forward_kinematics(size_t frame) const {
  std::vector<Eigen::Vector3d> positions;
  positions.reserve(num_joints());
  for (const Rigid3& joint : world_from_joint(frame)) positions.push_back(joint.translation);
  return positions;
}

std::vector<Eigen::Vector3d> Clip::rest_positions() const {
  std::vector<Eigen::Vector3d> positions(num_joints());
  for (size_t j = 0; j < num_joints(); ++j) {
    const int parent = joints[j].parent_idx;
    check(parent >= -1 && parent < static_cast<int>(j), "clip '{}': parent {} of joint {} does not come before it",
          name, parent, j);
    positions[j] = joints[j].offset;
    if (parent >= 0) positions[j] += positions[static_cast<size_t>(parent)];
  }
  return positions;
}

}  // namespace silpose
