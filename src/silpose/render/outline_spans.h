// OutlineSpans: the inside of a mesh's outline on sampled rows, as spans whose ends are exact and know the edge of the
// mesh that they lie on: what a silhouette's coverage, and its derivative, are made of.
// Based on: the non-zero winding rule, as OutlineScan; here in floating point, without rounding to a grid.
// Threads: one thread per object.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "silpose/render/silhouette.h"

namespace silpose {

// Where an edge of the outline crosses a row.
struct SpanEnd {
  float x = 0;      // image pixels
  float dx_dy = 0;  // of the edge, along the outline
  float t = 0;      // the crossing is (1 - t) * vertex a + t * vertex b
  uint32_t vertex_a = 0, vertex_b = 0;
};

// Rows y = first + r * step, r = 0 .. count - 1, in image pixels.
struct SampledRows {
  float first = 0, step = 1;
  int count = 0;
};

class OutlineSpans {
 public:
  explicit OutlineSpans(const EdgeTopology& topology);  // keeps a reference

  // Scans the mesh whose vertices are projected to `pixels` [V]; faces with a vertex that is NaN are left out.
  void scan(std::span<const Eigen::Vector2f> pixels, const SampledRows& rows);

  // Calls visit(row, left end, right end) for the spans inside, row by row, left to right; spans never overlap.
  template <class Visit>
  void for_each_span(Visit&& visit);

 private:
  struct Crossing {
    float x;
    uint32_t edge;  // index into edges_
    float t;
    int change;
  };
  struct Edge {
    uint32_t vertex_a, vertex_b;  // a above b
    float dx_dy;
  };
  [[nodiscard]] SpanEnd end_of(const Crossing& crossing) const;
  void find_facing(std::span<const Eigen::Vector2f> pixels);

  const EdgeTopology* topology_;
  std::vector<int8_t> facing_;     // [F + 1] 1, -1, or 0: left out; the last stands for a missing neighbour
  std::vector<uint32_t> outline_;  // [edges] the first few are edges whose two faces differ
  std::vector<Edge> edges_;
  std::vector<std::vector<Crossing>> row_crossings_;
  int row_begin_ = 0, row_end_ = 0;  // rows with crossings
};

inline SpanEnd OutlineSpans::end_of(const Crossing& crossing) const {
  const Edge& edge = edges_[crossing.edge];
  return {crossing.x, edge.dx_dy, crossing.t, edge.vertex_a, edge.vertex_b};
}

template <class Visit>
void OutlineSpans::for_each_span(Visit&& visit) {
  for (int row = row_begin_; row < row_end_; ++row) {
    auto& crossings = row_crossings_[static_cast<size_t>(row)];
    std::sort(crossings.begin(), crossings.end(), [](const Crossing& a, const Crossing& b) { return a.x < b.x; });
    int winding = 0;
    const Crossing* start = nullptr;
    for (const Crossing& crossing : crossings) {
      if (winding == 0) start = &crossing;
      winding += crossing.change;
      if (winding == 0) visit(row, end_of(*start), end_of(crossing));
    }
  }
}

}  // namespace silpose
