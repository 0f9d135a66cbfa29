// OutlineScan: the inside of a mesh's outline on a raster, as spans of pixels, by the non-zero winding rule.
// Every face turned towards the camera is wound the same way, so the winding number of a point is the number of faces
// above it, and only edges between a face that faces the camera and one that does not (or none) change it.
// Threads: one thread per object.
#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "silpose/render/raster_grid.h"
#include "silpose/render/silhouette.h"

namespace silpose {

class OutlineScan {
 public:
  explicit OutlineScan(const EdgeTopology& topology);  // keeps a reference

  // Scans the mesh whose vertices are projected to `points` [V]. `some_unseen` tells whether any is kUnseenPoint.
  void scan(std::span<const GridPoint> points, bool some_unseen, int width, int height);

  // Calls visit(y, x_begin, x_end) for the pixels inside, row by row, left to right; spans never overlap.
  template <class Visit>
  void for_each_span(Visit&& visit);

 private:
  // Where the winding number changes on a row: column << 3 | change + 4; changes lie in [-2, 2].
  using Crossing = uint32_t;

  void find_facing(std::span<const GridPoint> points);
  void find_facing_of_seen(std::span<const GridPoint> points);
  // An edge of the outline that crosses rows [row_begin, row_end) of the raster, from its upper end downwards.
  struct OutlineEdge {
    GridPoint top;
    int32_t dx, dy;
    int row_begin, row_end;
    int change;
  };

  void find_outline();
  void orient_outline(std::span<const GridPoint> points);
  void add_crossings(const OutlineEdge& edge);
  void grow_rows();

  const EdgeTopology* topology_;
  std::vector<int8_t> facing_;     // [F + 1] 1, -1, or 0: left out; the last stands for a missing neighbour
  std::vector<uint32_t> outline_;  // [edges] the first num_outline_ are edges whose two faces differ
  size_t num_outline_ = 0;
  std::vector<OutlineEdge> edges_;  // [edges] the first num_edges_ cross a row
  size_t num_edges_ = 0;
  int width_ = 0, height_ = 0;
  int row_begin_ = 0, row_end_ = 0;  // rows with crossings
  uint32_t row_capacity_ = 32;
  std::vector<uint32_t> row_size_;   // [height]
  std::vector<Crossing> crossings_;  // [height, row_capacity]
};

template <class Visit>
void OutlineScan::for_each_span(Visit&& visit) {
  for (int y = row_begin_; y < row_end_; ++y) {
    Crossing* const begin = crossings_.data() + static_cast<size_t>(y) * row_capacity_;
    Crossing* const end = begin + row_size_[static_cast<size_t>(y)];
    std::sort(begin, end);
    int winding = 0;
    int start = 0;
    for (const Crossing* crossing = begin; crossing != end; ++crossing) {
      const auto column = static_cast<int>(*crossing >> 3);
      if (winding == 0) start = column;
      winding += static_cast<int>(*crossing & 7) - 4;
      if (winding == 0 && start < column) visit(y, start, column);
    }
    if (winding != 0) visit(y, start, width_);  // crossings right of the raster are not kept
  }
}

}  // namespace silpose
