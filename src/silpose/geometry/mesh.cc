#include "silpose/geometry/mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

namespace silpose {

bool is_closed(std::span<const Face> faces) {
  using Edge = std::pair<uint32_t, uint32_t>;
  std::vector<Edge> edges, reversed;
  edges.reserve(3 * faces.size());
  for (const Face& face : faces) {
    for (size_t k = 0; k < 3; ++k) {
      if (face[k] == face[(k + 1) % 3]) return false;
      edges.emplace_back(face[k], face[(k + 1) % 3]);
    }
  }
  // Every directed edge occurs once, and its reverse occurs: the sorted lists are equal and without repeats.
  reversed = edges;
  for (Edge& edge : reversed) std::swap(edge.first, edge.second);
  std::sort(edges.begin(), edges.end());
  std::sort(reversed.begin(), reversed.end());
  return edges == reversed && std::adjacent_find(edges.begin(), edges.end()) == edges.end();
}

double volume(const Mesh& mesh) {
  double sum = 0;
  for (const Face& face : mesh.faces) {
    const Eigen::Vector3d a = mesh.vertices[face[0]].cast<double>();
    const Eigen::Vector3d b = mesh.vertices[face[1]].cast<double>();
    const Eigen::Vector3d c = mesh.vertices[face[2]].cast<double>();
    sum += a.dot(b.cross(c));
  }
  return sum / 6;
}

}  // namespace silpose
