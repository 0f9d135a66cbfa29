// For tests: small rigs that are not built as the human is. Threads: functions without state.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "silpose/body/default_profile.h"
#include "silpose/body/test_body.h"

namespace silpose {

// A square pole of 1.5 m, 0.2 m wide, that stands fixed on the floor and bends at four joints, 0.3 m apart: a chain
// whose root has no DOF. 8 DOF: bone1_rx bone1_rz ... bone4_rz, 50 degrees either way. End point: tip.
inline BodyModel make_chain_body() {
  constexpr int kBones = 4;
  constexpr double kBone = 0.3, kHalfWidth = 0.1, kHeight = (kBones + 1) * kBone;
  std::vector<Joint> joints = {{.name = "base"}};
  std::vector<Dof> dofs;
  std::vector<Rigid3> joint_from_rest = {Rigid3{}};
  for (int b = 1; b <= kBones; ++b) {
    const std::string name = "bone" + std::to_string(b);
    const int first = static_cast<int>(dofs.size());
    joints.push_back(
        {.name = name, .parent_idx = b - 1, .offset_in_parent = {0, kBone, 0}, .dof_indices = {first, first + 1}});
    for (const int axis : {0, 2}) {
      dofs.push_back({.name = name + (axis == 0 ? "_rx" : "_rz"),
                      .joint_idx = b,
                      .axis = Eigen::Vector3d::Unit(axis),
                      .lower = to_radians(-50),
                      .upper = to_radians(50)});
    }
    joint_from_rest.push_back({Eigen::Matrix3d::Identity(), {0, -b * kBone, 0}});
  }
  BodyModel body{.name = "pole",
                 .skeleton = Skeleton("pole", std::move(joints), std::move(dofs)),
                 .rest = {},
                 .skin = {.row_start = {0}, .joint_idx = {}, .weight = {}},
                 .joint_from_rest = std::move(joint_from_rest),
                 .end_points = {{"tip", kBones, {0, kBone, 0}}},
                 .height_m = kHeight};
  // Rings at the joints, shared by the bones that meet there, and in the middle between them.
  constexpr uint32_t kRings = 2 * (kBones + 1) + 1;
  for (uint32_t ring = 0; ring < kRings; ++ring) {
    for (const auto& [sx, sz] : {std::pair{1, 1}, {1, -1}, {-1, -1}, {-1, 1}}) {
      body.rest.vertices.emplace_back(
          Eigen::Vector3d(sx * kHalfWidth, ring * kBone / 2, sz * kHalfWidth).cast<float>());
      const auto bone = static_cast<uint16_t>(std::min<uint32_t>(ring / 2, kBones));
      const bool is_shared = ring % 2 == 0 && ring > 0 && ring + 1 < kRings;
      if (is_shared) body.skin.joint_idx.push_back(static_cast<uint16_t>(bone - 1));
      body.skin.joint_idx.push_back(bone);
      body.skin.weight.insert(body.skin.weight.end(), is_shared ? 2 : 1, is_shared ? 0.5F : 1.0F);
      body.skin.row_start.push_back(static_cast<uint32_t>(body.skin.weight.size()));
    }
  }
  const auto add_quad = [&](uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    body.rest.faces.push_back({a, b, c});
    body.rest.faces.push_back({a, c, d});
  };
  for (uint32_t ring = 0; ring + 1 < kRings; ++ring) {
    for (uint32_t k = 0; k < 4; ++k) {
      const uint32_t a = 4 * ring + k, b = 4 * ring + (k + 1) % 4;
      add_quad(a, b, b + 4, a + 4);
    }
  }
  const uint32_t top = 4 * (kRings - 1);
  add_quad(3, 2, 1, 0);
  add_quad(top, top + 1, top + 2, top + 3);
  body.profile = default_profile(body);
  return body;
}

// make_test_body() as a tool with Z up would have it: its joints' own axes are x, -z, y of the world, the DOF of the
// rotations come first, and the translations, last, are bounded: 3 m. 8 DOF: root_ry middle_rx middle_rz tip_rx tip_rz
// root_tz root_tx root_ty, about and along the same directions of the world as those of the test body.
inline BodyModel make_rotations_first_body() {
  Eigen::Matrix3d world_from_own;
  world_from_own << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  const Eigen::Matrix3d own_from_world = world_from_own.transpose();
  BodyModel body = make_test_body();
  const auto old = body.skeleton.dofs();
  std::vector<Dof> dofs(old.begin() + 3, old.end());
  for (const size_t translation : {2, 0, 1}) {
    dofs.push_back(old[translation]);
    dofs.back().lower = -3;
    dofs.back().upper = 3;
    dofs.back().is_bounded = true;
  }
  for (Dof& dof : dofs) dof.axis = own_from_world * dof.axis;
  std::vector<Joint> joints(body.skeleton.joints().begin(), body.skeleton.joints().end());
  joints[0].dof_indices = {5, 6, 7, 0};
  joints[0].parent_from_rest = world_from_own;
  joints[1].dof_indices = {1, 2};
  joints[2].dof_indices = {3, 4};
  for (const size_t j : {1, 2}) joints[j].offset_in_parent = own_from_world * joints[j].offset_in_parent;
  for (Rigid3& joint_from_rest : body.joint_from_rest) {
    joint_from_rest = Rigid3{own_from_world, Eigen::Vector3d::Zero()} * joint_from_rest;
  }
  for (BodyModel::EndPoint& end : body.end_points) end.offset_in_joint = own_from_world * end.offset_in_joint;
  body.skeleton = Skeleton("turned tube", std::move(joints), std::move(dofs));
  body.profile = default_profile(body);
  return body;
}

// The pose [8] of make_rotations_first_body() that looks like this one of make_test_body().
inline std::vector<double> rotations_first(const std::vector<double>& pose) {
  return {pose[3], pose[4], pose[5], pose[6], pose[7], pose[2], pose[0], pose[1]};
}

}  // namespace silpose
