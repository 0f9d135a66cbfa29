#include "silpose/render/outline_spans.h"

#include <cmath>

#include "silpose/base/check.h"

namespace silpose {

OutlineSpans::OutlineSpans(const EdgeTopology& topology)
    : topology_(&topology), facing_(topology.faces.size() + 1, 0), outline_(topology.edges.faces.size() + 1) {}

void OutlineSpans::find_facing(std::span<const Eigen::Vector2f> pixels) {
  const Eigen::Vector2f* const point = pixels.data();
  const Face* const face = topology_->faces.data();
  int8_t* const facing = facing_.data();
  const size_t count = topology_->faces.size();
  for (size_t f = 0; f < count; ++f) {
    const Eigen::Vector2f a = point[face[f][0]], b = point[face[f][1]], c = point[face[f][2]];
    const float area = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
    facing[f] = static_cast<int8_t>(area >= 0 ? 1 : area < 0 ? -1 : 0);  // NaN is neither
  }
}

void OutlineSpans::scan(std::span<const Eigen::Vector2f> pixels, const SampledRows& rows) {
  check(pixels.size() >= topology_->num_vertices, "OutlineSpans: {} points for {} vertices", pixels.size(),
        topology_->num_vertices);
  find_facing(pixels);
  const auto* const edge_faces = topology_->edges.faces.data();
  const int8_t* const facing = facing_.data();
  const auto num_edges = static_cast<uint32_t>(topology_->edges.faces.size());
  size_t num_outline = 0;
  for (uint32_t e = 0; e < num_edges; ++e) {  // branch-free: few are kept, and not predictably
    outline_[num_outline] = e;
    num_outline += static_cast<size_t>(facing[edge_faces[e][0]] != facing[edge_faces[e][1]]);
  }

  for (int row = row_begin_; row < row_end_; ++row) row_crossings_[static_cast<size_t>(row)].clear();
  row_crossings_.resize(static_cast<size_t>(rows.count));
  edges_.clear();
  row_begin_ = rows.count;
  row_end_ = 0;
  const float rows_per_pixel = 1 / rows.step;
  for (size_t i = 0; i < num_outline; ++i) {
    const uint32_t e = outline_[i];
    auto [a, b] = topology_->edges.vertices[e];
    int change = facing[edge_faces[e][0]] - facing[edge_faces[e][1]];
    if (pixels[b].y() < pixels[a].y()) std::swap(a, b), change = -change;
    const Eigen::Vector2f top = pixels[a], bottom = pixels[b];
    // Rows with top <= y < bottom: decided by each vertex alone, so that every row's changes add up to none.
    const auto row_from = [&](float y) {
      const float row = std::ceil((y - rows.first) * rows_per_pixel);
      return static_cast<int>(std::clamp(row, 0.0f, static_cast<float>(rows.count)));
    };
    const int begin = row_from(top.y()), end = row_from(bottom.y());
    if (begin >= end) continue;
    const float inverse_height = 1 / (bottom.y() - top.y());
    const float dx_dy = (bottom.x() - top.x()) * inverse_height;
    const auto edge = static_cast<uint32_t>(edges_.size());
    edges_.push_back({a, b, dx_dy});
    for (int row = begin; row < end; ++row) {
      const float below_top = rows.first + static_cast<float>(row) * rows.step - top.y();
      row_crossings_[static_cast<size_t>(row)].push_back(
          {top.x() + dx_dy * below_top, edge, below_top * inverse_height, change});
    }
    row_begin_ = std::min(row_begin_, begin);
    row_end_ = std::max(row_end_, end);
  }
  if (row_begin_ > row_end_) row_begin_ = row_end_ = 0;
}

}  // namespace silpose
