// OutlineSpans: the inside of a mesh's outline on sampled rows, as spans whose ends are exact and know the edge of the
// mesh that they lie on: what a silhouette's coverage, and its derivative, are made of.
// Based on: the non-zero winding rule, as OutlineScan; here in floating point, without rounding to a grid.
// Threads: one thread per object.
#pragma once

#include <Eigen/Core>
#include <bit>
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

  // Scans the mesh whose vertices are projected to `pixels` [V]. Faces with a vertex that is NaN are left out;
  // `some_unseen` tells whether there may be any.
  void scan(std::span<const Eigen::Vector2f> pixels, const SampledRows& rows, bool some_unseen);

  // Calls visit(row, left, right) for the spans inside, row by row, left to right; spans never overlap. What is visited
  // has .x() of the end, in image pixels, and .end() with all that is known of it.
  template <class Visit>
  void for_each_span(Visit&& visit) const;

  // What scan() works on: an edge whose two faces are turned to different sides, or that has one only.
  struct OutlineEdge {
    uint32_t from, to;
    int change;  // of the winding number, crossing it where it runs down
  };

 private:
  struct Edge {
    uint32_t vertex_a, vertex_b;  // a above b
    int change;                   // of the winding number, to the right of it
    int row_begin, row_end;       // that it crosses
    float top_x, top_y, dx_dy, inverse_height;
  };
  // A crossing is one number, so that sorting a row moves little: x in the upper half, as an integer of the same order;
  // then the edge; then the change, plus 2, in the lowest three bits.
  using Crossing = uint64_t;
  class End {
   public:
    End(const OutlineSpans& spans, Crossing crossing, int row) : spans_(&spans), crossing_(crossing), row_(row) {}
    [[nodiscard]] float x() const { return x_of(crossing_); }
    [[nodiscard]] SpanEnd end() const;

   private:
    const OutlineSpans* spans_;
    Crossing crossing_;
    int row_;
  };
  static Crossing crossing_of(float x, uint32_t edge, int change) {
    const auto bits = std::bit_cast<uint32_t>(x);
    const uint32_t ordered = bits ^ (static_cast<uint32_t>(-static_cast<int32_t>(bits >> 31)) | 0x80000000u);
    return static_cast<uint64_t>(ordered) << 32 | (edge << 3 | static_cast<uint32_t>(change + 2));
  }
  static float x_of(Crossing crossing) {
    const auto ordered = static_cast<uint32_t>(crossing >> 32);
    const uint32_t mask = ordered >> 31 ? 0x80000000u : 0xffffffffu;
    return std::bit_cast<float>(ordered ^ mask);
  }
  static int change_of(Crossing crossing) { return static_cast<int>(crossing & 7) - 2; }
  [[nodiscard]] float y_below(const Edge& edge, int row) const {
    return rows_.first + static_cast<float>(row) * rows_.step - edge.top_y;
  }
  void find_outline(std::span<const Eigen::Vector2f> pixels);
  void find_outline_among_seen(std::span<const Eigen::Vector2f> pixels);
  void add_outline(uint32_t from, uint32_t to, int change) { outline_[num_outline_++] = {from, to, change}; }
  size_t find_edges(std::span<const Eigen::Vector2f> pixels);
  void sort_rows();

  const EdgeTopology* topology_;
  SampledRows rows_;
  std::vector<Eigen::Vector2f> strip_points_;  // [positions + padding]
  std::vector<uint8_t> winding_;               // [positions / 8 + padding] bits: the strip order winds anticlockwise
  std::vector<uint64_t> found_;                // scratch
  std::vector<int8_t> facing_;                 // [F + 1] 1, -1, or 0: left out; the last stands for a missing neighbour
  std::vector<OutlineEdge> outline_;           // [edges + padding] the first few: whose two faces differ
  size_t num_outline_ = 0;
  std::vector<Edge> edges_;          // [edges] the first few: of the outline, that cross rows
  std::vector<uint32_t> row_start_;  // [rows + 1] crossings of row r: row_start_[r] to row_start_[r + 1]
  std::vector<Crossing> crossings_;  // by row, left to right
};

inline SpanEnd OutlineSpans::End::end() const {
  const Edge& edge = spans_->edges_[static_cast<uint32_t>(crossing_) >> 3];
  return {x(), edge.dx_dy, spans_->y_below(edge, row_) * edge.inverse_height, edge.vertex_a, edge.vertex_b};
}

template <class Visit>
void OutlineSpans::for_each_span(Visit&& visit) const {
  for (int row = 0; row < rows_.count; ++row) {
    int winding = 0;
    Crossing start = 0;
    for (uint32_t i = row_start_[static_cast<size_t>(row)]; i < row_start_[static_cast<size_t>(row) + 1]; ++i) {
      const Crossing crossing = crossings_[i];
      if (winding == 0) start = crossing;
      winding += change_of(crossing);
      if (winding == 0) visit(row, End(*this, start, row), End(*this, crossing, row));
    }
  }
}

}  // namespace silpose
