#include "silpose/render/outline_spans.h"

#include <algorithm>
#include <utility>

#include "silpose/base/check.h"

namespace silpose {
namespace {

constexpr size_t kShortRow = 24;  // crossings: up to here comparing all pairs beats a sort that branches

// The lowest integer not below `value`, clamped to [0, count]; std::ceil is a call where there is no SSE 4.
int ceil_within(float value, float count) {
  const float clamped = std::min(std::max(value, 0.0f), count);
  const int truncated = static_cast<int>(clamped);
  return truncated + static_cast<int>(static_cast<float>(truncated) < clamped);
}

}  // namespace

OutlineSpans::OutlineSpans(const EdgeTopology& topology)
    : topology_(&topology),
      facing_(topology.faces.size() + 1, 0),
      outline_(topology.edges.faces.size() + 1),
      edges_(topology.edges.faces.size() + 1) {}

void OutlineSpans::find_facing(std::span<const Eigen::Vector2f> pixels) {
  const Eigen::Vector2f* const point = pixels.data();
  const Face* const face = topology_->faces.data();
  int8_t* const facing = facing_.data();
  const size_t count = topology_->faces.size();
  for (size_t f = 0; f < count; ++f) {
    const Eigen::Vector2f a = point[face[f][0]], b = point[face[f][1]], c = point[face[f][2]];
    const float area = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
    // Without branches, which nothing predicts; NaN is neither.
    facing[f] = static_cast<int8_t>(static_cast<int>(area >= 0) - static_cast<int>(area < 0));
  }
}

// Edges of the outline that cross rows, into edges_; counts the crossings of each row into row_start_.
size_t OutlineSpans::find_edges(std::span<const Eigen::Vector2f> pixels) {
  const auto* const edge_faces = topology_->edges.faces.data();
  const auto* const edge_vertices = topology_->edges.vertices.data();
  const int8_t* const facing = facing_.data();
  const auto num_edges = static_cast<uint32_t>(topology_->edges.faces.size());
  size_t num_outline = 0;
  for (uint32_t e = 0; e < num_edges; ++e) {  // branch-free: few are kept, and not predictably
    outline_[num_outline] = e;
    num_outline += static_cast<size_t>(facing[edge_faces[e][0]] != facing[edge_faces[e][1]]);
  }

  const float rows_per_pixel = 1 / rows_.step, row_count = static_cast<float>(rows_.count);
  row_start_.assign(static_cast<size_t>(rows_.count) + 1, 0);
  size_t num_kept = 0;
  for (size_t i = 0; i < num_outline; ++i) {
    const uint32_t e = outline_[i];
    const auto [from, to] = edge_vertices[e];
    const int change = facing[edge_faces[e][0]] - facing[edge_faces[e][1]];
    const bool upwards = pixels[to].y() < pixels[from].y();
    const uint32_t a = upwards ? to : from, b = upwards ? from : to;
    const Eigen::Vector2f top = pixels[a], bottom = pixels[b];
    // Rows with top <= y < bottom: decided by each vertex alone, so that every row's changes add up to none.
    const int begin = ceil_within((top.y() - rows_.first) * rows_per_pixel, row_count);
    const int end = ceil_within((bottom.y() - rows_.first) * rows_per_pixel, row_count);
    const float inverse_height = 1 / (bottom.y() - top.y());
    edges_[num_kept] = {a,
                        b,
                        upwards ? -change : change,
                        begin,
                        end,
                        top.x(),
                        top.y(),
                        (bottom.x() - top.x()) * inverse_height,
                        inverse_height};
    num_kept += static_cast<size_t>(begin < end);
    ++row_start_[static_cast<size_t>(begin)];
    --row_start_[static_cast<size_t>(end)];
  }
  return num_kept;
}

void OutlineSpans::scan(std::span<const Eigen::Vector2f> pixels, const SampledRows& rows) {
  check(pixels.size() >= topology_->num_vertices, "OutlineSpans: {} points for {} vertices", pixels.size(),
        topology_->num_vertices);
  rows_ = rows;
  find_facing(pixels);
  const size_t num_edges = find_edges(pixels);

  // From edges that begin and end, to crossings of each row, to where its crossings end.
  uint32_t in_row = 0, total = 0;
  for (uint32_t& start : row_start_) {
    in_row += start;
    start = total;
    total += in_row;
  }
  crossings_.resize(total);
  for (uint32_t i = 0; i < num_edges; ++i) {
    const Edge& edge = edges_[i];
    for (int row = edge.row_begin; row < edge.row_end; ++row) {
      const float x = edge.top_x + edge.dx_dy * y_below(edge, row);
      crossings_[row_start_[static_cast<size_t>(row)]++] = crossing_of(x, i, edge.change);
    }
  }
  std::copy_backward(row_start_.begin(), row_start_.end() - 1, row_start_.end());  // ends are the next row's starts
  row_start_.front() = 0;
  sort_rows();
}

void OutlineSpans::sort_rows() {
  for (size_t row = 0; row + 1 < row_start_.size(); ++row) {
    Crossing* const crossing = crossings_.data() + row_start_[row];
    const size_t count = row_start_[row + 1] - row_start_[row];
    if (count > kShortRow) {
      std::sort(crossing, crossing + count);
      continue;
    }
    // Where each belongs: how many are less. No two are equal.
    uint8_t rank[kShortRow] = {};
    for (size_t i = 1; i < count; ++i) {
      const Crossing x = crossing[i];
      unsigned rank_i = 0;
      for (size_t j = 0; j < i; ++j) {
        const bool less = crossing[j] < x;
        rank_i += static_cast<unsigned>(less);
        rank[j] = static_cast<uint8_t>(rank[j] + static_cast<unsigned>(!less));
      }
      rank[i] = static_cast<uint8_t>(rank_i);
    }
    Crossing sorted[kShortRow];
    for (size_t i = 0; i < count; ++i) sorted[rank[i]] = crossing[i];
    std::copy_n(sorted, count, crossing);
  }
}

}  // namespace silpose
