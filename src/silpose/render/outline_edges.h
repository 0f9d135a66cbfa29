// OutlineEdges: which edges of a projected mesh lie on its outline, directed so that the interior is on the same side
// of all of them. By Highway, built for every instruction set and chosen at run time; the same for all of them.
// An edge lies on the outline when its two faces are turned to different sides of the camera, or when it has one face
// only. Exact: on the grid, which side a face is turned to is decided in integers.
// Threads: one thread per object.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "silpose/render/raster_grid.h"
#include "silpose/render/silhouette.h"

namespace silpose {

class OutlineEdges {
 public:
  explicit OutlineEdges(const EdgeTopology& topology);  // keeps a reference

  // Finds the outline of the mesh whose vertices are projected to `points` [V, and more that only `cut_faces` name].
  // Faces with an unseen vertex are left out; `some_unseen` is whether there is any. The cut faces, which replace them,
  // are separate surfaces: all their edges are of one face.
  void find(std::span<const GridPoint> points, bool some_unseen, std::span<const Face> cut_faces = {});

  // Edges from[i] to to[i]. Crossing one changes the winding number by the same sign; by two where both faces count.
  struct Edges {
    std::vector<GridPoint> from, to;
    size_t count = 0;
  };
  [[nodiscard]] const Edges& between_faces() const { return inner_; }
  [[nodiscard]] const Edges& of_one_face() const { return border_; }

 private:
  void find_among_seen(std::span<const GridPoint> points);
  void add_faces(std::span<const GridPoint> points, std::span<const Face> faces);

  const EdgeTopology* topology_;
  std::vector<GridPoint> strip_points_;  // [positions + padding]
  std::vector<uint8_t> winding_;         // [positions / 8 + padding] bits: the strip order winds anticlockwise
  std::vector<uint64_t> found_;          // [3 x runs or pairs] scratch
  std::vector<int8_t> facing_;           // [F + 1] only where something is unseen
  Edges inner_, border_;
};

}  // namespace silpose
