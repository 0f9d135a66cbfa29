// The metric surface of a body of two angles: the distance of an observed silhouette to that of every whole degree of
// both, as section 4.7 of the thesis draws it for each frame (references.bib: cormier2019).
#include <algorithm>
#include <cmath>

#include "benches.h"
#include "figure.h"
#include "silhouette_scene.h"
#include "silpose/base/rng.h"

namespace silpose::bench {
namespace {

constexpr double kBone = 0.7, kThick = 0.12, kThin = 0.05;  // metres: length of each bone, radius at root and tip

// A closed tapered tube of two bones along +Y, bent in the image's plane by one angle each; rest and zero pose are
// straight. 60 rings of 16 vertices and two middles: 962 vertices.
BodyModel make_two_bone_tube() {
  constexpr uint32_t kRings = 60, kSides = 16;
  constexpr double kBlend = 0.06;  // metres to either side of the bend over which weights change
  Mesh mesh;
  SkinWeights skin{.row_start = {0}, .joint_idx = {}, .weight = {}};
  const auto add_vertex = [&](double radius, double y, double around) {
    mesh.vertices.emplace_back(Eigen::Vector3d(radius * std::sin(around), y, radius * std::cos(around)).cast<float>());
    const double outer = std::clamp((y - kBone + kBlend) / (2 * kBlend), 0.0, 1.0);
    for (const auto& [joint, weight] : {std::pair<uint16_t, double>{0, 1 - outer}, {1, outer}}) {
      if (weight <= 0) continue;
      skin.joint_idx.push_back(joint);
      skin.weight.push_back(static_cast<float>(weight));
    }
    skin.row_start.push_back(static_cast<uint32_t>(skin.weight.size()));
  };
  for (uint32_t ring = 0; ring < kRings; ++ring) {
    const double part = static_cast<double>(ring) / (kRings - 1);
    for (uint32_t k = 0; k < kSides; ++k) {
      add_vertex(kThick + part * (kThin - kThick), part * 2 * kBone, 2 * kPi * k / kSides);
    }
  }
  const uint32_t bottom = kRings * kSides, top = bottom + 1, last_ring = bottom - kSides;
  add_vertex(0, 0, 0);
  add_vertex(0, 2 * kBone, 0);
  for (uint32_t k = 0; k < kSides; ++k) {
    const uint32_t next = (k + 1) % kSides;
    for (uint32_t ring = 0; ring < last_ring; ring += kSides) {
      mesh.faces.push_back({ring + k, ring + next, ring + next + kSides});
      mesh.faces.push_back({ring + k, ring + next + kSides, ring + k + kSides});
    }
    mesh.faces.push_back({bottom, next, k});
    mesh.faces.push_back({top, last_ring + k, last_ring + next});
  }
  verify(is_closed(mesh.faces) && volume(mesh) > 0, "the tube is not closed");

  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ(), along(0, kBone, 0);
  return {.name = "two-bone tube",
          .skeleton = Skeleton(
              "two-bone tube",
              {{.name = "inner", .parent_idx = -1, .dof_indices = {0}},
               {.name = "outer", .parent_idx = 0, .offset_in_parent = along, .dof_indices = {1}}},
              {{.name = "inner_rz", .joint_idx = 0, .is_periodic = true, .axis = z, .lower = -kPi, .upper = kPi},
               {.name = "outer_rz", .joint_idx = 1, .is_periodic = true, .axis = z, .lower = -kPi, .upper = kPi}}),
          .rest = std::move(mesh),
          .skin = std::move(skin),
          .joint_from_rest = {{}, {Eigen::Matrix3d::Identity(), -along}}};
}

constexpr int kDegrees = 361;  // -180 to 180
constexpr size_t kNumPoses = static_cast<size_t>(kDegrees) * kDegrees;
constexpr int kTrueInner = 25, kTrueOuter = -50;

SilhouetteScene surface_scene() {
  constexpr int kSize = 128;
  SilhouetteScene scene{.body = std::make_shared<BodyModel>(make_two_bone_tube()),
                        .camera = look_at_camera(640, 480, 700, {0, 0, 6}, {0, 0, 0})};
  const double kExtent = 400;  // pixels: a reach of 1.4 m, 6 m away, either way
  scene.window = {.x0 = scene.camera.cx - kExtent / 2,
                  .y0 = scene.camera.cy - kExtent / 2,
                  .scale_x = kSize / kExtent,
                  .scale_y = kSize / kExtent,
                  .width = kSize,
                  .height = kSize};
  scene.num_poses = kNumPoses;
  scene.num_dofs = 2;
  for (int inner = -180; inner <= 180; ++inner) {
    for (int outer = -180; outer <= 180; ++outer) {
      scene.poses.push_back(to_radians(inner));
      scene.poses.push_back(to_radians(outer));
    }
  }
  scene.observed = plain_silhouette(scene, {{to_radians(kTrueInner), to_radians(kTrueOuter)}});
  return scene;
}

}  // namespace

Figure metric_surface_s(int rounds) {
  const SilhouetteScene scene = surface_scene();
  const BatchRenderer renderer(scene.body, scene.camera);
  const std::vector<int64_t> surface = our_distances(scene, renderer, 0, kNumPoses, scene.observed);
  const auto least = static_cast<size_t>(std::ranges::min_element(surface) - surface.begin());
  const size_t truth = static_cast<size_t>(kTrueInner + 180) * kDegrees + kTrueOuter + 180;
  verify(least == truth && surface[truth] <= 1, "the least of the surface is not at the true pose");
  verify(std::ranges::count(surface, surface[truth]) == 1, "the least of the surface is not alone");
  // As a turn by -180 and by 180 degrees is the same.
  for (size_t i = 0; i < kDegrees; ++i) {
    verify(std::abs(surface[i * kDegrees] - surface[i * kDegrees + kDegrees - 1]) <= 2, "the surface is not periodic");
  }
  Rng rng(1);
  for (int check = 0; check < 200; ++check) {
    const size_t n = rng.index(kNumPoses);
    verify(std::abs(surface[n] - plain_distances(scene, n, 1, scene.observed)[0]) <= 2, "distance of a pose");
  }

  constexpr size_t kEvery = 41;  // the peer takes its time: it gets every so many poses
  SilhouetteScene sample = scene;
  sample.poses.clear();
  for (size_t n = 0; n < kNumPoses; n += kEvery) {
    for (const double angle : scene.pose(n)) sample.poses.push_back(angle);
  }
  sample.num_poses = sample.poses.size() / sample.num_dofs;
  const Contestant ours{.name = "ours",
                        .run = [&] { keep(our_distances(scene, renderer, 0, kNumPoses, scene.observed)); }};
  const Contestant plain{.name = "plain renderer, every triangle filled",
                         .amount = static_cast<double>(sample.num_poses) / kNumPoses,
                         .run = [&] { keep(plain_distances(sample, 0, sample.num_poses, sample.observed)); }};
  return measure({.unit = "s", .higher_is_better = false, .rounds = rounds}, ours, std::span(&plain, 1));
}

}  // namespace silpose::bench
