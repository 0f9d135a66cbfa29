#include "silpose/body/test_body.h"

#include <algorithm>
#include <array>

namespace silpose {
namespace {

constexpr double kPelvis = 0.5, kMiddle = 0.7, kTip = 1.1, kTop = 1.5, kHalfWidth = 0.15;
constexpr double kBlend = 0.1;  // metres to either side of a joint over which weights change

// How much of a vertex at height `y` lies above the joint at `joint_y`.
double above(double y, double joint_y) { return std::clamp((y - joint_y + kBlend) / (2 * kBlend), 0.0, 1.0); }

Skeleton make_skeleton() {
  std::vector<Joint> joints = {
      {.name = "root", .parent_idx = -1, .dof_indices = {0, 1, 2, 3}},
      {.name = "middle", .parent_idx = 0, .offset_in_parent = {0, kMiddle - kPelvis, 0}, .dof_indices = {4, 5}},
      {.name = "tip", .parent_idx = 1, .offset_in_parent = {0, kTip - kMiddle, 0}, .dof_indices = {6, 7}},
  };
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), y = Eigen::Vector3d::UnitY(), z = Eigen::Vector3d::UnitZ();
  std::vector<Dof> dofs = {
      {"root_tx", 0, true, false, x, -10, 10},
      {"root_ty", 0, true, false, y, 0, 3},
      {"root_tz", 0, true, false, z, -10, 10},
      {"root_ry", 0, false, true, y, -kPi, kPi},
      {"middle_rx", 1, false, false, x, to_radians(-30), to_radians(90)},
      {"middle_rz", 1, false, false, z, to_radians(-60), to_radians(60)},
      {"tip_rx", 2, false, false, x, to_radians(-30), to_radians(90)},
      {"tip_rz", 2, false, false, z, to_radians(-60), to_radians(60)},
  };
  return Skeleton("tube", std::move(joints), std::move(dofs));
}

}  // namespace

BodyModel make_test_body() {
  constexpr std::array<double, 9> kRings = {0, 0.3, 0.6, 0.7, 0.8, 1.0, 1.1, 1.2, kTop};
  Mesh mesh;
  SkinWeights skin{.row_start = {0}, .joint_idx = {}, .weight = {}};
  for (const double y : kRings) {
    const double tip = above(y, kTip), middle = above(y, kMiddle) - tip;
    const std::array<double, 3> weights = {1 - middle - tip, middle, tip};
    for (const auto& [sx, sz] : {std::pair{1, 1}, {1, -1}, {-1, -1}, {-1, 1}}) {
      mesh.vertices.emplace_back(Eigen::Vector3d(sx * kHalfWidth, y, sz * kHalfWidth).cast<float>());
      for (uint16_t j = 0; j < 3; ++j) {
        if (weights[j] < 1e-9) continue;
        skin.joint_idx.push_back(j);
        skin.weight.push_back(static_cast<float>(weights[j]));
      }
      skin.row_start.push_back(static_cast<uint32_t>(skin.weight.size()));
    }
  }
  const auto add_quad = [&](uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    mesh.faces.push_back({a, b, c});
    mesh.faces.push_back({a, c, d});
  };
  for (uint32_t ring = 0; ring + 1 < kRings.size(); ++ring) {
    for (uint32_t k = 0; k < 4; ++k) {
      const uint32_t a = 4 * ring + k, b = 4 * ring + (k + 1) % 4;
      add_quad(a, b, b + 4, a + 4);
    }
  }
  const uint32_t top = 4 * (kRings.size() - 1);
  add_quad(3, 2, 1, 0);
  add_quad(top, top + 1, top + 2, top + 3);

  std::vector<Rigid3> joint_from_rest(3);
  joint_from_rest[0].translation = {0, -kPelvis, 0};
  joint_from_rest[1].translation = {0, -kMiddle, 0};
  joint_from_rest[2].translation = {0, -kTip, 0};
  return {.name = "tube",
          .skeleton = make_skeleton(),
          .rest = std::move(mesh),
          .skin = std::move(skin),
          .joint_from_rest = std::move(joint_from_rest),
          .end_points = {{"tip_end", 2, {0, kTop - kTip, 0}}},
          .height_m = kTop,
          .weight_kg = 4 * kHalfWidth * kHalfWidth * kTop * 980,
          .facts = {{"source", "made by hand"}}};
}

}  // namespace silpose
