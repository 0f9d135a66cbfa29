// OutlineSpans: the inside of a mesh's outline on sampled rows, as spans whose ends are exact and refer to the edge of
// the mesh that they lie on: a silhouette's coverage, and its derivative, are computed from them.
// Based on: the non-zero winding rule, as OutlineScan; here in floating point, without rounding to a grid.
// Threads: one thread per object.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "silpose/render/silhouette.h"
#include "silpose/render/span_kernels.h"

namespace silpose {

class OutlineSpans {
 public:
  explicit OutlineSpans(const EdgeTopology& topology);  // keeps a reference

  // Scans the mesh whose vertices are projected to `pixels` [V]. Faces with a vertex that is NaN are left out;
  // `some_unseen` is whether there may be any.
  void scan(std::span<const Eigen::Vector2f> pixels, const SampledRows& rows, bool some_unseen);

  // The ends of the spans inside, in no particular order, until the next scan(). A row has as many beginnings as ends;
  // left to right they alternate.
  [[nodiscard]] SpanEnds ends() const {
    return {end_x_.data(), end_side_.data(), end_row_.data(), end_edge_.data(), num_ends_};
  }

  // The edge on which an end lies, and where: at (1 - t) * vertex a + t * vertex b.
  struct OnEdge {
    uint32_t vertex_a = 0, vertex_b = 0;
    float t = 0;
    float dx_dy = 0;  // of the edge, along the outline
  };
  [[nodiscard]] OnEdge edge_of(size_t end_idx) const {
    const auto edge = static_cast<size_t>(end_edge_[end_idx]);
    const float y = rows_.first + static_cast<float>(end_row_[end_idx]) * rows_.step;
    return {static_cast<uint32_t>(vertex_a_[edge]), static_cast<uint32_t>(vertex_b_[edge]),
            (y - top_y_[edge]) * inverse_height_[edge], dx_dy_[edge]};
  }

 private:
  void find_outline(std::span<const Eigen::Vector2f> pixels);
  void find_outline_among_seen(std::span<const Eigen::Vector2f> pixels);
  void add_outline(uint32_t from, uint32_t to, int change);
  RowEdges row_edges() {
    return {vertex_a_.data(), vertex_b_.data(), change_.data(), row_begin_.data(),     row_end_.data(),
            top_x_.data(),    top_y_.data(),    dx_dy_.data(),  inverse_height_.data()};
  }
  size_t group_rows(size_t num_edges);
  void find_ends(size_t num_edges);

  const EdgeTopology* topology_;
  SampledRows rows_;
  std::vector<uint8_t> winding_;  // [positions / 8 + spare] bits: the strip order winds anticlockwise
  std::vector<uint64_t> found_;   // scratch
  std::vector<int8_t> facing_;    // [F + 1] 1, -1, or 0: left out; the last is a missing neighbour
  std::vector<uint32_t> outline_from_, outline_to_;  // [edges + spare] the first few
  std::vector<int32_t> outline_change_;
  size_t num_outline_ = 0;
  // [edges + spare] the first few: of the outline, that cross rows.
  std::vector<int32_t> vertex_a_, vertex_b_, change_, row_begin_, row_end_;
  std::vector<float> top_x_, top_y_, dx_dy_, inverse_height_;
  std::vector<uint32_t> next_;           // [rows + 1] of each row, in grouped_; before: how many more edges than above
  std::vector<RowGroup> groups_;         // [rows / kGroupRows]
  std::vector<Crossing> crossings_;      // [crossings + spare] edge by edge
  std::vector<int32_t> crossing_row_;    // [crossings + spare]
  std::vector<GroupCrossings> grouped_;  // by group, then of each row one after another
  std::vector<int32_t> end_row_, end_edge_;  // [ends + spare]
  std::vector<float> end_x_, end_side_;
  size_t num_ends_ = 0;
};

}  // namespace silpose
