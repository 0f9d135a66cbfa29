// Mesh: an indexed triangle mesh, and the checks to make before trusting its silhouette.
// Threads: values and pure functions.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace silpose {

using Face = std::array<uint32_t, 3>;

struct Mesh {
  std::vector<Eigen::Vector3f> vertices;  // [V] metres
  std::vector<Face> faces;                // [F] counter-clockwise seen from outside
};

// True when every edge is shared by exactly two faces that run along it in opposite directions.
bool is_closed(std::span<const Face> faces);

// Volume enclosed by a closed mesh, cubic metres; positive when faces point outwards.
double volume(const Mesh& mesh);

}  // namespace silpose
