#include <algorithm>
#include <tuple>

#include "silpose/render/silhouette.h"

namespace silpose {
namespace {

struct HalfEdge {
  uint32_t low, high;  // its vertices, in order of index
  bool upwards;        // the face runs along it from low to high
  uint32_t face, side;
};

}  // namespace

EdgeTopology::EdgeTopology(std::span<const Face> mesh_faces)
    : faces(mesh_faces.begin(), mesh_faces.end()), neighbour(mesh_faces.size(), {-1, -1, -1}) {
  std::vector<HalfEdge> halves;
  halves.reserve(3 * faces.size());
  for (uint32_t f = 0; f < faces.size(); ++f) {
    for (uint32_t side = 0; side < 3; ++side) {
      const uint32_t a = faces[f][side], b = faces[f][(side + 1) % 3];
      halves.push_back({std::min(a, b), std::max(a, b), a < b, f, side});
      num_vertices = std::max(num_vertices, a + 1);
    }
  }
  std::ranges::sort(halves, {}, [](const HalfEdge& h) { return std::tuple(h.low, h.high, h.upwards, h.face, h.side); });

  const auto none = static_cast<uint32_t>(faces.size());
  const auto add_edge = [&](uint32_t from, uint32_t to, uint32_t along, uint32_t against) {
    edges.vertices.push_back({from, to});
    edges.faces.push_back({along, against});
  };
  for (size_t begin = 0, end = 0; begin < halves.size(); begin = end) {
    // One edge's half edges: the downward ones first, then the upward ones; the k-th of each are neighbours.
    const auto same_edge = [&](size_t i) {
      return halves[i].low == halves[begin].low && halves[i].high == halves[begin].high;
    };
    size_t first_up = begin;
    while (first_up < halves.size() && same_edge(first_up) && !halves[first_up].upwards) ++first_up;
    end = first_up;
    while (end < halves.size() && same_edge(end)) ++end;
    const size_t num_down = first_up - begin, num_up = end - first_up;
    for (size_t k = 0; k < std::max(num_down, num_up); ++k) {
      const HalfEdge* down = k < num_down ? &halves[begin + k] : nullptr;
      const HalfEdge* up = k < num_up ? &halves[first_up + k] : nullptr;
      if (down && up) {
        neighbour[down->face][down->side] = static_cast<int32_t>(up->face);
        neighbour[up->face][up->side] = static_cast<int32_t>(down->face);
      }
      if (up) {
        add_edge(up->low, up->high, up->face, down ? down->face : none);
      } else {
        add_edge(down->high, down->low, down->face, none);
      }
    }
  }
  strips = StripOrder(faces, neighbour);
}

}  // namespace silpose
