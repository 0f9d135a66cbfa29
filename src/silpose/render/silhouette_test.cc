#include "silpose/render/silhouette.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "silpose/base/rng.h"
#include "silpose/base/simd_targets.h"

namespace silpose {
namespace {

using Pixels = std::vector<Eigen::Vector2f>;

struct Shape {
  Pixels pixels;
  std::vector<Face> faces;
};

// Draws both ways, the fast one under every instruction set; they must agree to the pixel.
Mask draw(const Pixels& pixels, const std::vector<Face>& faces, const Window& window) {
  Mask reference, fast;
  draw_silhouette_reference(pixels, faces, window, reference);
  const EdgeTopology topology(faces);
  OutlineRenderer renderer(topology);
  Mask observed(window.width, window.height);
  for (int y = 0; y < window.height; ++y) {
    for (int x = 0; x < window.width; ++x) observed.set(x, y, (x * 7 + y * 5) % 11 < 5);
  }
  for_each_simd_target([&](const char* name) {
    renderer.draw(pixels, window, fast);
    EXPECT_EQ(fast, reference) << name << "\n" << text_from_mask(fast) << "\n" << text_from_mask(reference);
    const OutlineRenderer::Counts counts = renderer.count(pixels, window, observed);
    EXPECT_EQ(counts.model, reference.count()) << name;
    EXPECT_EQ(counts.both, and_count(reference, observed)) << name;
  });
  return reference;
}

// A closed surface: a torus-like or sphere-like grid of quads, with vertices scattered by `noise` pixels.
Shape closed_grid(int rings, int sectors, double radius, double noise, Rng& rng) {
  Shape shape;
  for (int r = 0; r < rings; ++r) {
    for (int s = 0; s < sectors; ++s) {
      const double a = 2 * kPi * r / rings, b = 2 * kPi * s / sectors;
      const double ring = radius * (0.65 + 0.35 * std::cos(b));
      shape.pixels.emplace_back(
          static_cast<float>(32 + ring * std::cos(a) + noise * rng.normal()),
          static_cast<float>(32 + 0.8 * ring * std::sin(a) + 6 * std::sin(b) + noise * rng.normal()));
    }
  }
  const auto index = [&](int r, int s) { return static_cast<uint32_t>((r % rings) * sectors + s % sectors); };
  for (int r = 0; r < rings; ++r) {
    for (int s = 0; s < sectors; ++s) {
      shape.faces.push_back({index(r, s), index(r + 1, s), index(r + 1, s + 1)});
      shape.faces.push_back({index(r, s), index(r + 1, s + 1), index(r, s + 1)});
    }
  }
  return shape;
}

TEST(Silhouette, FillsPixelsWhoseCentresAreInside) {
  const Window window{.width = 6, .height = 4};
  EXPECT_EQ(text_from_mask(draw({{1, 1}, {5, 1}, {1, 4}}, {{0, 1, 2}}, window)), "......\n.###..\n.##...\n.#....\n");
  // Turned the other way, it is the same silhouette.
  EXPECT_EQ(draw({{1, 1}, {5, 1}, {1, 4}}, {{0, 2, 1}}, window).count(), 6);
}

TEST(Silhouette, CentresOnLeftAndTopEdgesAreInside) {
  const Window window{.width = 5, .height = 5};
  const Pixels square = {{0.5f, 0.5f}, {3.5f, 0.5f}, {3.5f, 3.5f}, {0.5f, 3.5f}};
  EXPECT_EQ(text_from_mask(draw(square, {{0, 1, 2}, {0, 2, 3}}, window)), "###..\n###..\n###..\n.....\n.....\n");
}

TEST(Silhouette, WindowCropsAndScales) {
  const Window window{.x0 = 10, .y0 = 20, .scale_x = 2, .scale_y = 0.5, .width = 4, .height = 3};
  const Pixels square = {{10.5f, 20}, {11.5f, 20}, {11.5f, 24}, {10.5f, 24}};
  EXPECT_EQ(text_from_mask(draw(square, {{0, 1, 2}, {0, 2, 3}}, window)), ".##.\n.##.\n....\n");
}

TEST(Silhouette, HolesStayOpenAndOverlapsDoNotCancel) {
  Rng rng(3);
  const Shape ring = closed_grid(24, 8, 28, 0, rng);
  const Mask mask = draw(ring.pixels, ring.faces, {.width = 64, .height = 64});
  EXPECT_FALSE(mask.get(32, 32));
  EXPECT_TRUE(mask.get(32 + 22, 32));
  // One quad in front of another, wound the opposite way.
  const Pixels two = {{1, 1}, {9, 1}, {9, 9}, {1, 9}, {4, 4}, {12, 4}, {12, 12}, {4, 12}};
  const Mask both = draw(two, {{0, 1, 2}, {0, 2, 3}, {4, 6, 5}, {4, 7, 6}}, {.width = 16, .height = 16});
  EXPECT_EQ(both.count(), 64 + 64 - 25);
}

TEST(Silhouette, FoldedSurfacesAgree) {
  Rng rng(11);
  for (int i = 0; i < 400; ++i) {
    const Shape shape = closed_grid(5 + i % 20, 3 + i % 7, 4 + i % 40, 0.02 * (i % 300), rng);
    draw(shape.pixels, shape.faces, {.width = 50 + i % 40, .height = 64});
  }
}

TEST(Silhouette, AnyTrianglesAgree) {
  // Vertices on a coarse lattice, so that centres on edges, slivers, repeated vertices and faces are common; faces at
  // random, so that edges are shared by one, two or many faces running either way.
  Rng rng(5);
  for (int i = 0; i < 3000; ++i) {
    Shape shape;
    const uint64_t num_vertices = 3 + rng.index(12);
    const float step = i % 2 == 0 ? 0.5f : 0.00390625f;
    const float spread = i % 5 == 0 ? 4000.0f : 24.0f;
    for (uint64_t v = 0; v < num_vertices; ++v) {
      const auto x = static_cast<float>(rng.uniform(-0.3, 1.3)), y = static_cast<float>(rng.uniform(-0.3, 1.3));
      shape.pixels.emplace_back(std::round(x * spread / step) * step, std::round(y * spread / step) * step);
    }
    for (uint64_t f = 0; f < 1 + rng.index(20); ++f) {
      const auto vertex = [&] { return static_cast<uint32_t>(rng.index(num_vertices)); };
      shape.faces.push_back({vertex(), vertex(), vertex()});
    }
    draw(shape.pixels, shape.faces, {.width = 24, .height = 20});
  }
}

TEST(Silhouette, VerticesThatAreNotSeenTakeTheirTrianglesAlong) {
  Rng rng(8);
  for (int i = 0; i < 200; ++i) {
    Shape shape = closed_grid(12, 6, 25, 2, rng);
    for (int k = 0; k <= i % 9; ++k) {
      shape.pixels[rng.index(shape.pixels.size())].x() = std::numeric_limits<float>::quiet_NaN();
    }
    draw(shape.pixels, shape.faces, {.width = 64, .height = 64});
  }
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(draw({{nan, nan}, {nan, 0}, {0, nan}}, {{0, 1, 2}}, {.width = 4, .height = 4}).count(), 0);
}

TEST(Silhouette, HugeAndFarAwayTrianglesAgree) {
  const float infinity = std::numeric_limits<float>::infinity();
  const Window window{.width = 70, .height = 9};
  EXPECT_EQ(draw({{-1e9f, -1e9f}, {1e9f, -1e9f}, {0, 1e9f}}, {{0, 1, 2}}, window).count(), 70 * 9);
  EXPECT_EQ(draw({{-infinity, -5}, {infinity, -5}, {3, infinity}}, {{0, 1, 2}}, window).count(), 70 * 9);
  EXPECT_EQ(draw({{500, 1}, {600, 1}, {500, 8}}, {{0, 1, 2}}, window).count(), 0);
  EXPECT_EQ(draw({{-500, 1}, {-400, 1}, {-500, 8}}, {{0, 1, 2}}, window).count(), 0);
  EXPECT_EQ(draw({{5, -50}, {60, -50}, {5, -1}}, {{0, 1, 2}}, window).count(), 0);
  Rng rng(2);
  for (int i = 0; i < 500; ++i) {
    Pixels pixels;
    for (int k = 0; k < 3; ++k) {
      pixels.emplace_back(static_cast<float>(rng.normal() * 1e5), static_cast<float>(rng.normal() * 1e5));
    }
    draw(pixels, {{0, 1, 2}}, window);
  }
}

TEST(Silhouette, ManyCrossingsOnOneRow) {
  Shape comb;
  for (uint32_t k = 0; k < 100; ++k) {
    const auto x = static_cast<float>(2 * k);
    for (const auto& [dx, y] : {std::pair{0.0f, 0.0f}, {1.0f, 0.0f}, {1.0f, 3.0f}}) comb.pixels.emplace_back(x + dx, y);
    comb.faces.push_back({3 * k, 3 * k + 1, 3 * k + 2});
  }
  EXPECT_GT(draw(comb.pixels, comb.faces, {.width = 200, .height = 3}).count(), 100);
}

TEST(Silhouette, OneRendererServesWindowsOfAnySize) {
  Rng rng(4);
  const Shape shape = closed_grid(20, 8, 28, 1, rng);
  const EdgeTopology topology(shape.faces);
  OutlineRenderer renderer(topology);
  Mask fast, reference;
  for (const int size : {64, 200, 17, 64, 3}) {
    const Window window{.scale_x = size / 64.0, .scale_y = size / 64.0, .width = size, .height = size + 1};
    renderer.draw(shape.pixels, window, fast);
    draw_silhouette_reference(shape.pixels, shape.faces, window, reference);
    EXPECT_EQ(fast, reference) << size;
  }
}

TEST(Silhouette, RefusesWhatCannotBeDrawn) {
  const std::vector<Face> faces = {{0, 1, 5}};
  const EdgeTopology topology(faces);
  OutlineRenderer renderer(topology);
  Mask mask;
  EXPECT_THROW(renderer.draw(Pixels(3), {.width = 4, .height = 4}, mask), std::invalid_argument);
  EXPECT_THROW(draw_silhouette_reference(Pixels(3), faces, {.width = 4, .height = 4}, mask), std::invalid_argument);
  EXPECT_THROW((void)renderer.count(Pixels(6), {.width = 4, .height = 4}, Mask(3, 3)), std::invalid_argument);
}

TEST(EdgeTopology, KnowsNeighbours) {
  // A tetrahedron: every edge has two faces.
  const EdgeTopology closed(std::vector<Face>{{0, 1, 2}, {0, 3, 1}, {1, 3, 2}, {2, 3, 0}});
  EXPECT_EQ(closed.neighbour[0], (std::array<int32_t, 3>{1, 2, 3}));
  EXPECT_EQ(closed.neighbour[1], (std::array<int32_t, 3>{3, 2, 0}));
  EXPECT_EQ(closed.edges.faces.size(), 6u);
  EXPECT_EQ(closed.num_vertices, 4u);
  // Without one face, its three edges lose a neighbour.
  const EdgeTopology open(std::vector<Face>{{0, 1, 2}, {0, 3, 1}, {1, 3, 2}});
  EXPECT_EQ(open.neighbour[0], (std::array<int32_t, 3>{1, 2, -1}));
  EXPECT_EQ(open.edges.faces.size(), 6u);
  // Faces that run the same way along their edge are no neighbours.
  const EdgeTopology twisted(std::vector<Face>{{0, 1, 2}, {0, 1, 3}});
  EXPECT_EQ(twisted.neighbour[0][0], -1);
  EXPECT_EQ(twisted.edges.faces.size(), 6u);
}

TEST(SimdTargets, AreSeveralOnThisProcessor) {
  std::vector<std::string> names;
  for_each_simd_target([&](const char* name) { names.emplace_back(name); });
  EXPECT_GE(names.size(), 2u);
}

TEST(Projection, LeavesOutWhatIsBehindTheCamera) {
  const PinholeCamera camera = default_camera(640, 480);
  const std::vector<Eigen::Vector3f> vertices = {{0, 1.5f, 0}, {0, 1.5f, 5.49f}, {0, 1.5f, 9}, {1, 1.5f, 0}};
  Pixels pixels(vertices.size());
  project_vertices(camera, vertices, pixels);
  EXPECT_NEAR(pixels[0].x(), 320, 1e-3);
  EXPECT_NEAR(pixels[0].y(), 240, 1e-3);
  EXPECT_TRUE(std::isnan(pixels[1].x()));
  EXPECT_TRUE(std::isnan(pixels[2].y()));
  const auto bounds = pixel_bounds(pixels);
  ASSERT_TRUE(bounds);
  EXPECT_NEAR(bounds->x1 - bounds->x0, 1.2 * 640 / 5.5, 1e-2);
  EXPECT_FALSE(pixel_bounds(std::span(pixels).subspan(1, 2)));
}

}  // namespace
}  // namespace silpose
