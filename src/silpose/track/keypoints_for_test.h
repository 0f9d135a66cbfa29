// For tests: a small body that has a left and a right, and the keypoints that a network would find on it.
// Threads: functions without state.
#pragma once

#include <string>
#include <utility>

#include "silpose/body/default_profile.h"
#include "silpose/body/test_body.h"
#include "silpose/image/observation.h"
#include "silpose/shape/keypoint_axes.h"

namespace silpose {

// make_test_body() with hips and shoulders: joints right_thigh, left_thigh, right_upper_arm and left_upper_arm, which
// do not move by themselves. DOF and mesh are the same. Its silhouette hardly distinguishes front from back.
inline BodyModel make_sided_body() {
  BodyModel body = make_test_body();
  std::vector<Joint> joints(body.skeleton.joints().begin(), body.skeleton.joints().end());
  std::vector<Dof> dofs(body.skeleton.dofs().begin(), body.skeleton.dofs().end());
  for (const auto& [name, parent, offset] : {std::tuple{"right_thigh", 0, Eigen::Vector3d(-0.1, 0, 0)},
                                             {"left_thigh", 0, Eigen::Vector3d(0.1, 0, 0)},
                                             {"right_upper_arm", 2, Eigen::Vector3d(-0.15, 0.2, 0)},
                                             {"left_upper_arm", 2, Eigen::Vector3d(0.15, 0.2, 0)}}) {
    joints.push_back({.name = name, .parent_idx = parent, .offset_in_parent = offset});
    Rigid3 joint_from_rest = body.joint_from_rest[static_cast<size_t>(parent)];
    joint_from_rest.translation -= offset;
    body.joint_from_rest.push_back(joint_from_rest);
  }
  body.skeleton = Skeleton("sided tube", std::move(joints), std::move(dofs));
  body.profile = default_profile(body);
  body.profile.facing = Eigen::Vector3d::UnitZ();
  body.profile.across = {{3, 4}, {5, 6}};
  return body;
}

// The keypoints of a pose, in the image and in space. Where the sides are `exchanged` the network takes left for right
// and sees the body mirrored in depth. REQUIRES: the observation has its mask; the whole body is in front of the
// camera.
inline void add_keypoints(const BodyModel& body, const PinholeCamera& camera, std::span<const double> pose,
                          Observation& seen, bool exchanged = false) {
  const auto names = landmark_names(body);
  const auto positions = landmark_positions(body, pose);
  const Box box = seen.box();
  seen.keypoints_3d = {box.x + 0.5 * box.width, box.y + 0.5 * box.height, {}};
  const Eigen::Matrix3d keypoints_from_world = world_from_keypoints(camera, seen.keypoints_3d).transpose();
  for (size_t i = 0; i < names.size(); ++i) {
    std::string name = names[i];
    if (exchanged && name.starts_with("left_")) {
      name = "right_" + name.substr(5);
    } else if (exchanged && name.starts_with("right_")) {
      name = "left_" + name.substr(6);
    }
    const Eigen::Vector2d pixel = camera.project(positions[i]).value();
    const Eigen::Vector3d x = keypoints_from_world * (positions[i] - positions[0]);
    seen.keypoints_2d.push_back({name, pixel.x(), pixel.y()});
    seen.keypoints_3d.points.push_back({name, {x.x(), x.y(), exchanged ? -x.z() : x.z()}});
  }
}

}  // namespace silpose
