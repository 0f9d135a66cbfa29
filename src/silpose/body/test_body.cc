#include "silpose/body/test_body.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "silpose/body/default_profile.h"

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

constexpr uint32_t kBallRings = 7, kBallSides = 16;
constexpr double kBallRadius = 0.2, kBallsApart = 1;

void add_ball(const Eigen::Vector3d& centre, Mesh& mesh) {
  const auto first = static_cast<uint32_t>(mesh.vertices.size());
  const auto add_vertex = [&](double polar, double around) {
    const Eigen::Vector3d towards(std::sin(polar) * std::sin(around), std::cos(polar),
                                  std::sin(polar) * std::cos(around));
    mesh.vertices.emplace_back((centre + kBallRadius * towards).cast<float>());
  };
  for (uint32_t i = 1; i <= kBallRings; ++i) {
    for (uint32_t k = 0; k < kBallSides; ++k) add_vertex(kPi * i / (kBallRings + 1), 2 * kPi * k / kBallSides);
  }
  add_vertex(0, 0);
  add_vertex(kPi, 0);
  const uint32_t top = first + kBallRings * kBallSides, last = (kBallRings - 1) * kBallSides;
  for (uint32_t k = 0; k < kBallSides; ++k) {
    const uint32_t a = first + k, b = first + (k + 1) % kBallSides;
    mesh.faces.push_back({top, a, b});
    mesh.faces.push_back({top + 1, b + last, a + last});
    for (uint32_t ring = 0; ring < last; ring += kBallSides) {
      mesh.faces.push_back({a + ring, a + ring + kBallSides, b + ring});
      mesh.faces.push_back({b + ring, a + ring + kBallSides, b + ring + kBallSides});
    }
  }
}

}  // namespace

BodyModel make_ball_body() {
  const Eigen::Vector3d lift(0, kBallRadius, 0), across(kBallsApart, 0, 0);
  BodyModel body{
      .name = "balls",
      .skeleton = Skeleton(
          "balls",
          {{.name = "root", .parent_idx = -1, .offset_in_parent = lift, .dof_indices = {0, 1}},
           {.name = "tip", .parent_idx = 0, .offset_in_parent = across, .dof_indices = {2}}},
          {{.name = "root_ty", .joint_idx = 0, .is_translation = true, .axis = {0, 1, 0}, .lower = -1, .upper = 1},
           {.name = "root_rz", .joint_idx = 0, .axis = {0, 0, 1}, .lower = -1, .upper = 1},
           {.name = "tip_tx", .joint_idx = 1, .is_translation = true, .axis = {1, 0, 0}, .lower = -1, .upper = 1}}),
      .joint_from_rest = {{Eigen::Matrix3d::Identity(), -lift}, {Eigen::Matrix3d::Identity(), -lift - across}}};
  add_ball(lift, body.rest);
  const size_t of_root = body.rest.vertices.size();
  add_ball(lift + across, body.rest);
  for (size_t v = 0; v < body.rest.vertices.size(); ++v) {
    body.skin.row_start.push_back(static_cast<uint32_t>(v));
    body.skin.joint_idx.push_back(v < of_root ? 0 : 1);
    body.skin.weight.push_back(1);
  }
  body.skin.row_start.push_back(static_cast<uint32_t>(body.rest.vertices.size()));
  body.height_m = 2 * kBallRadius;
  body.profile = default_profile(body);
  return body;
}

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
  BodyModel body{.name = "tube",
                 .skeleton = make_skeleton(),
                 .rest = std::move(mesh),
                 .skin = std::move(skin),
                 .joint_from_rest = std::move(joint_from_rest),
                 .end_points = {{"tip_end", 2, {0, kTop - kTip, 0}}},
                 .height_m = kTop,
                 .weight_kg = 4 * kHalfWidth * kHalfWidth * kTop * 980,
                 .facts = {{"source", "made by hand"}}};
  body.profile = default_profile(body);
  body.profile.facing = Eigen::Vector3d::UnitZ();
  return body;
}

}  // namespace silpose
