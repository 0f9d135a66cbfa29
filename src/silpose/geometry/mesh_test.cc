#include "silpose/geometry/mesh.h"

#include <gtest/gtest.h>

namespace silpose {
namespace {

Mesh box(float width, float height, float depth) {
  Mesh mesh;
  for (int corner = 0; corner < 8; ++corner) {
    mesh.vertices.emplace_back(corner & 1 ? width : 0, corner & 2 ? height : 0, corner & 4 ? depth : 0);
  }
  mesh.faces = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

TEST(Mesh, BoxIsClosedAndHasItsVolume) {
  Mesh mesh = box(2, 3, 0.5F);
  EXPECT_TRUE(is_closed(mesh.faces));
  EXPECT_NEAR(volume(mesh), 3.0, 1e-9);
  for (auto& vertex : mesh.vertices) vertex += Eigen::Vector3f(10, -20, 5);
  EXPECT_NEAR(volume(mesh), 3.0, 1e-3);
}

TEST(Mesh, TurnedInsideOutHasNegativeVolume) {
  Mesh mesh = box(1, 1, 1);
  for (Face& face : mesh.faces) std::swap(face[1], face[2]);
  EXPECT_TRUE(is_closed(mesh.faces));
  EXPECT_NEAR(volume(mesh), -1.0, 1e-9);
}

TEST(Mesh, HoleFlippedFaceDoubledFaceAndCollapsedFaceAreNotClosed) {
  const Mesh mesh = box(1, 1, 1);
  auto hole = mesh.faces;
  hole.pop_back();
  EXPECT_FALSE(is_closed(hole));
  auto flipped = mesh.faces;
  std::swap(flipped[4][0], flipped[4][1]);
  EXPECT_FALSE(is_closed(flipped));
  auto doubled = mesh.faces;
  doubled.insert(doubled.end(), mesh.faces.begin(), mesh.faces.end());
  EXPECT_FALSE(is_closed(doubled));
  auto collapsed = mesh.faces;
  collapsed.push_back({0, 0, 0});
  EXPECT_FALSE(is_closed(collapsed));
}

}  // namespace
}  // namespace silpose
