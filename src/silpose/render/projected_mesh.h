// ProjectedMesh: a mesh in a camera's image. Faces that cross the near plane are cut: first there, then to the
// image and some room around it, since what is cut off near the camera projects far off, where coordinates leave the
// grid and a distortion polynomial folds back. Faces that lie wholly beyond the near plane are kept as they are.
// Source: polygon clipping (references.bib: sutherland1974).
// Threads: a value and a pure function.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "silpose/geometry/camera.h"
#include "silpose/geometry/mesh.h"

namespace silpose {

struct ProjectedMesh {
  // Where the corner of a cut face lies: on a face of the mesh, by the weights of its corners.
  struct CutVertex {
    uint32_t face = 0;
    Eigen::Vector3d weights;
    double depth = 0;  // metres along the camera's axis
  };
  std::vector<Eigen::Vector2f> pixels;  // [V + cut vertices] the mesh's own first; NaN: nearer than kNear
  std::vector<CutVertex> cut_vertices;  // of pixels[V], pixels[V + 1], ..
  std::vector<Face> cut_faces;          // of cut vertices, by their place in `pixels`
};

// Vertices in world coordinates. The same vertices in another order give the same pixels, bit for bit. What `mesh` has
// room for is used again.
void project_mesh(const PinholeCamera& camera, std::span<const Eigen::Vector3f> vertices_in_world,
                  std::span<const Face> faces, ProjectedMesh& mesh);

}  // namespace silpose
