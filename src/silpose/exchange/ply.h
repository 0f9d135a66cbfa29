// PLY: the vertices of a mesh, as depth cameras' tools write it. Read: "binary_little_endian 1.0" whose first element
// is `vertex` with scalar properties only, among them x, y and z of type float. Everything else of the file (texture
// coordinates, faces) is ignored.
// Based on: Greg Turk's PLY format (references.bib: turk1994).
// Threads: a function without state.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

#include "silpose/base/result.h"

namespace silpose {

// [V] vertices in the file's order, axes and unit. Errors: unreadable; not such a file; shorter than its header says; a
// coordinate that is not finite. Names the file.
Result<std::vector<Eigen::Vector3f>> read_ply_vertices(const std::filesystem::path& path);

}  // namespace silpose
