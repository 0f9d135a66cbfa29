#include "silpose/render/projected_mesh.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "silpose/base/rng.h"
#include "silpose/base/simd_targets.h"
#include "silpose/body/test_body.h"
#include "silpose/render/shaded.h"
#include "silpose/render/silhouette.h"

namespace silpose {
namespace {

using Vertices = std::vector<Eigen::Vector3f>;

PinholeCamera camera_at_origin() {
  PinholeCamera camera{.width = 64, .height = 48};
  camera.fx = camera.fy = 40;
  camera.cx = 32;
  camera.cy = 24;
  return camera;
}

// Draws both ways, the fast one under every instruction set; they must agree to the pixel.
Mask draw(const PinholeCamera& camera, const Vertices& vertices, const std::vector<Face>& faces, double scale = 1) {
  const Window window{.scale_x = scale, .scale_y = scale, .width = camera.width, .height = camera.height};
  ProjectedMesh mesh;
  project_mesh(camera, vertices, faces, mesh);
  Mask reference, fast;
  draw_silhouette_reference(mesh.pixels, faces, window, reference, mesh.cut_faces);
  const EdgeTopology topology(faces);
  OutlineRenderer renderer(topology);
  const Mask observed(window.width, window.height);
  for_each_simd_target([&](const char* name) {
    renderer.draw(mesh.pixels, window, fast, mesh.cut_faces);
    EXPECT_EQ(fast, reference) << name;
    EXPECT_EQ(renderer.count(mesh.pixels, window, observed, mesh.cut_faces).model, reference.count()) << name;
  });
  return reference;
}

// Whether the ray through a pixel's centre meets a triangle at kNear or beyond.
bool is_hit(const PinholeCamera& camera, int x, int y, const Vertices& v, const Face& face) {
  const Eigen::Vector3d ray = camera.ray_from_pixel({x + 0.5, y + 0.5});
  Eigen::Matrix3d corners;
  for (int k = 0; k < 3; ++k) corners.col(k) = camera.cam_from_world * v[face[static_cast<size_t>(k)]].cast<double>();
  const Eigen::Vector3d weights = corners.inverse() * ray;  // times depth
  return weights.minCoeff() >= 0 && 1 / weights.sum() >= PinholeCamera::kNear;
}

int64_t misses(const PinholeCamera& camera, const Vertices& vertices, const Face& face, const Mask& mask) {
  int64_t count = 0;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) count += is_hit(camera, x, y, vertices, face) != mask.get(x, y);
  }
  return count;
}

const std::vector<Face> kOneFace = {{0, 1, 2}};

TEST(ProjectedMesh, WhatIsSeenWhollyStaysAsItIs) {
  const PinholeCamera camera = camera_at_origin();
  const Vertices vertices = {{0, 0, 1}, {1, 0, 2}, {0, 1, 3}};
  ProjectedMesh mesh;
  project_mesh(camera, vertices, kOneFace, mesh);
  std::vector<Eigen::Vector2f> pixels(3);
  project_vertices(camera, vertices, pixels);
  EXPECT_EQ(mesh.pixels, pixels);
  EXPECT_TRUE(mesh.cut_faces.empty());
  // Behind the camera there is nothing to cut.
  project_mesh(camera, Vertices{{0, 0, -1}, {1, 0, -2}, {0, 1, -3}}, kOneFace, mesh);
  EXPECT_TRUE(mesh.cut_faces.empty());
  EXPECT_FALSE(pixel_bounds(mesh.pixels));
}

TEST(ProjectedMesh, RandomTrianglesAreCutWhereRaysSayThatTheyEnd) {
  const PinholeCamera camera = camera_at_origin();
  Rng rng(1);
  int64_t pixels = 0, wrong = 0;
  int cut = 0;
  for (int i = 0; i < 500; ++i) {
    Vertices vertices;
    for (int k = 0; k < 3; ++k) {
      vertices.push_back(Eigen::Vector3d(rng.normal(), rng.normal(), 0.5 * rng.normal()).cast<float>());
    }
    const auto nearer = std::ranges::count_if(vertices, [](const auto& v) { return v.z() < PinholeCamera::kNear; });
    if (nearer == 0 || nearer == 3) continue;
    ++cut;
    const Mask mask = draw(camera, vertices, kOneFace);
    pixels += mask.count();
    wrong += misses(camera, vertices, kOneFace[0], mask);
  }
  EXPECT_GT(cut, 200);
  EXPECT_GT(pixels, 20000);
  EXPECT_LE(wrong, pixels / 2000);  // centres on an edge, to the grid's 1/256 pixel
}

TEST(ProjectedMesh, ThroughABentLensWhatIsCutKeepsToTheImage) {
  // Far outside the image this lens folds back: corners there would land in it.
  PinholeCamera camera = camera_at_origin();
  camera.distortion = {-0.2, 0.02, 0.002, -0.001, 0};
  Rng rng(2);
  int64_t pixels = 0, wrong = 0;
  for (int i = 0; i < 300; ++i) {
    Vertices vertices;
    for (int k = 0; k < 3; ++k) {
      vertices.push_back(Eigen::Vector3d(rng.normal(), rng.normal(), k == 0 ? -1 : 0.04).cast<float>());
    }
    vertices[0] = Eigen::Vector3d(0.1 * rng.normal(), 0.1 * rng.normal(), 1 + rng.uniform()).cast<float>();
    const Mask mask = draw(camera, vertices, kOneFace);
    pixels += mask.count();
    wrong += misses(camera, vertices, kOneFace[0], mask);
  }
  EXPECT_GT(pixels, 20000);
  EXPECT_LE(wrong, pixels / 20);  // straight edges of triangles are bent in truth: some pixels next to each
}

TEST(ProjectedMesh, FacesThatShareAnEdgeLeaveNoGap) {
  // A fan around a vertex behind the camera, seen all over the image: rounding must not open it anywhere.
  const PinholeCamera camera = camera_at_origin();
  Rng rng(3);
  for (int i = 0; i < 100; ++i) {
    Vertices vertices = {Eigen::Vector3d(0.02 * rng.normal(), 0.3 * rng.normal(), -1).cast<float>()};
    std::vector<Face> faces;
    constexpr uint32_t kSides = 40;
    for (uint32_t k = 0; k < kSides; ++k) {
      const double angle = 2 * kPi * k / kSides;
      vertices.push_back(Eigen::Vector3d(30 * std::cos(angle), 30 * std::sin(angle), 1 + rng.uniform()).cast<float>());
      faces.push_back({0, 1 + k, 1 + (k + 1) % kSides});
    }
    const Vertices front = {{-60, -60, 1}, {60, -60, 1}, {0, 90, 1}};
    EXPECT_EQ(draw(camera, front, kOneFace).count(), 64 * 48);
    const Mask mask = draw(camera, vertices, faces);
    // The fan is a cone around the viewing axis whose tip lies behind: all but its inside beyond the rim is covered.
    for (int y = 0; y < 48; ++y) {
      const auto row = mask.row(y);
      if (row[0] == ~uint64_t{0}) continue;
      for (int x = 1; x < 63; ++x) {
        const bool hole = !mask.get(x, y) && mask.get(x - 1, y) && mask.get(x + 1, y);
        EXPECT_FALSE(hole) << x << ", " << y;
      }
    }
  }
}

TEST(ProjectedMesh, HostileValuesAreDrawnAlike) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity(), kNaN = std::numeric_limits<float>::quiet_NaN();
  const float values[] = {0, -1, 1, 0.05f, 0.0499999f, -0.05f, 1e-30f, 1e10f, -1e10f, 1e30f, -3e38f, kInfinity, kNaN};
  Rng rng(4);
  PinholeCamera camera = camera_at_origin();
  for (int i = 0; i < 3000; ++i) {
    camera.distortion[0] = i % 3 == 0 ? -0.3 : 0;
    Vertices vertices(5);
    for (Eigen::Vector3f& vertex : vertices) {
      for (float& value : vertex) value = values[rng.index(std::size(values))];
    }
    std::vector<Face> faces(4);
    for (Face& face : faces) {
      for (uint32_t& vertex : face) vertex = static_cast<uint32_t>(rng.index(vertices.size()));
    }
    draw(camera, vertices, faces, i % 2 == 0 ? 1 : 1e5);
  }
  camera.fx = camera.fy = 1e7;  // a view so narrow that everything else is far outside
  EXPECT_EQ(draw(camera, {{-1, -1, 1}, {1, -1, 1}, {0, 3, -1}}, kOneFace).count(), 64 * 48);
}

TEST(ProjectedMesh, TheOrderOfVerticesDoesNotMatter) {
  const PinholeCamera camera = camera_at_origin();
  Rng rng(5);
  for (int i = 0; i < 200; ++i) {
    Vertices vertices;
    for (int k = 0; k < 6; ++k) {
      vertices.push_back(Eigen::Vector3d(rng.normal(), rng.normal(), 0.5 * rng.normal()).cast<float>());
    }
    const std::vector<Face> faces = {{0, 1, 2}, {2, 1, 3}, {4, 5, 0}};
    const uint32_t to[] = {3, 5, 0, 1, 4, 2};
    Vertices others(6);
    for (size_t k = 0; k < 6; ++k) others[to[k]] = vertices[k];
    std::vector<Face> other_faces;
    for (const Face& face : faces) other_faces.push_back({to[face[0]], to[face[1]], to[face[2]]});
    ProjectedMesh one, other;
    project_mesh(camera, vertices, faces, one);
    project_mesh(camera, others, other_faces, other);
    ASSERT_EQ(one.pixels.size(), other.pixels.size());
    for (size_t k = 6; k < one.pixels.size(); ++k) EXPECT_EQ(one.pixels[k], other.pixels[k]);
    EXPECT_EQ(one.cut_faces, other.cut_faces);
  }
}

TEST(ProjectedMesh, BatchesCutAsTheReferenceDoes) {
  const auto body = std::make_shared<BodyModel>(make_test_body());
  const auto num_dofs = static_cast<size_t>(body->skeleton.num_dofs());
  PinholeCamera camera = look_at_camera(96, 72, 60, {0, 0.9, 0.35}, {0, 0.5, 0});
  for (const double k1 : {0.0, -0.1}) {
    camera.distortion[0] = k1;
    Rng rng(6);
    std::vector<double> poses;
    constexpr size_t kPoses = 60;
    for (size_t n = 0; n < kPoses; ++n) {
      for (size_t d = 0; d < num_dofs; ++d) poses.push_back(rng.uniform(-0.4, 0.4));
    }
    const Mask observed = render_silhouette(*body, camera, std::span(poses).first(num_dofs));
    const BatchRenderer renderer(body, camera);
    std::vector<OutlineRenderer::Counts> counts(kPoses), cropped(kPoses);
    renderer.counts({poses.data(), kPoses, num_dofs, num_dofs}, {.width = 96, .height = 72}, observed, counts);
    renderer.counts_cropped({poses.data(), kPoses, num_dofs, num_dofs}, Mask(32, 32), cropped);
    int cut = 0;
    for (size_t n = 0; n < kPoses; ++n) {
      const std::span pose = std::span(poses).subspan(n * num_dofs, num_dofs);
      ProjectedMesh mesh;
      project_mesh(camera, skin_vertices(*body, pose), body->rest.faces, mesh);
      if (mesh.cut_faces.empty()) continue;
      ++cut;
      const Mask mask = render_silhouette(*body, camera, pose);
      EXPECT_EQ(counts[n].model, mask.count());
      EXPECT_EQ(counts[n].both, and_count(mask, observed));
      EXPECT_EQ(cropped[n].model > 0, mask.count() > 0);
    }
    EXPECT_GT(cut, 10);
  }
}

TEST(ProjectedMesh, DepthOfACutFloorIsExact) {
  // The floor from half a metre above it, beyond and behind the camera.
  const PinholeCamera camera = look_at_camera(64, 48, 30, {0, 0.5, 0}, {0, 0.3, -1});
  const Vertices floor = {{-9, 0, -9}, {9, 0, -9}, {9, 0, 9}, {-9, 0, 9}};
  const Image<float> depth = draw_depth(camera, floor, std::vector<Face>{{0, 1, 2}, {0, 2, 3}});
  for (int x = 2; x < 64; x += 5) {
    for (int y = 24; y < 48; y += 3) {
      const Eigen::Vector3d ray =
          camera.cam_from_world.rotation.transpose() * camera.ray_from_pixel({x + 0.5, y + 0.5});
      EXPECT_NEAR(depth.at(x, y), -0.5 / ray.y(), 0.01) << x << ", " << y;
    }
  }
  ByteImage image(64, 48, 3, 255);
  draw_shaded(camera, floor, std::vector<Face>{{0, 1, 2}, {0, 2, 3}}, Vertices(4, {0.2f, 0.4f, 0.8f}),
              {.to_light = {0, -1, 0}, .ambient = 0}, image);
  EXPECT_EQ(image.at(32, 45, 0), 51);
  EXPECT_EQ(image.at(32, 45, 2), 204);
}

}  // namespace
}  // namespace silpose
