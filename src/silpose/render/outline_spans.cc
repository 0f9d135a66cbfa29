#include "silpose/render/outline_spans.h"

#include <algorithm>

#include "silpose/base/check.h"

namespace silpose {
namespace {

// Makes room for `count` numbers and what kernels write beyond them.
template <class T>
void grow(std::vector<T>& numbers, size_t count) {
  if (numbers.size() < count + kSpanSpare) numbers.resize(count + kSpanSpare);
}

}  // namespace

OutlineSpans::OutlineSpans(const EdgeTopology& topology) : topology_(&topology) {
  const StripOrder& strips = topology.strips;
  winding_.resize(strips.vertex.size() / 8 + kSpanSpare);
  found_.resize(std::max(3 * (strips.runs.size() + 1), strips.pairs.size() + 1));
  const size_t most = std::max(strips.num_inner_edges + strips.borders.size(), topology.edges.faces.size());
  for (auto* const numbers : {&outline_from_, &outline_to_}) grow(*numbers, most);
  for (auto* const numbers : {&outline_change_, &vertex_a_, &vertex_b_, &change_, &row_begin_, &row_end_}) {
    grow(*numbers, most);
  }
  for (auto* const numbers : {&top_x_, &top_y_, &dx_dy_, &inverse_height_}) grow(*numbers, most);
}

void OutlineSpans::add_outline(uint32_t from, uint32_t to, int change) {
  outline_from_[num_outline_] = from;
  outline_to_[num_outline_] = to;
  outline_change_[num_outline_++] = change;
}

// As OutlineEdges finds it, in floating point: strips in place of faces, long runs of edges in place of single ones.
void OutlineSpans::find_outline(std::span<const Eigen::Vector2f> pixels) {
  const StripOrder& strips = topology_->strips;
  find_winding(pixels.data()->data(), strips.vertex.data(), strips.num_positions, winding_.data());
  num_outline_ = find_inner_outline(view_of(strips), strips.vertex.data(), winding_.data(), found_.data(),
                                    {outline_from_.data(), outline_to_.data(), outline_change_.data()});
  std::fill_n(outline_change_.begin(), num_outline_, 2);
  for (const StripOrder::Border& border : strips.borders) {
    const size_t turned = winding_[border.position / 8] >> (border.position % 8) & 1;
    add_outline(strips.vertex[border.position + StripOrder::kSide[border.side][turned]],
                strips.vertex[border.position + StripOrder::kSide[border.side][turned ^ 1]], 1);
  }
}

void OutlineSpans::find_outline_among_seen(std::span<const Eigen::Vector2f> pixels) {
  const std::vector<Face>& faces = topology_->faces;
  facing_.assign(faces.size() + 1, 0);
  for (size_t f = 0; f < faces.size(); ++f) {
    const Eigen::Vector2f a = pixels[faces[f][0]], b = pixels[faces[f][1]], c = pixels[faces[f][2]];
    const float area = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
    facing_[f] = static_cast<int8_t>(area >= 0 ? 1 : area < 0 ? -1 : 0);  // NaN is neither
  }
  num_outline_ = 0;
  for (size_t e = 0; e < topology_->edges.faces.size(); ++e) {
    const auto [along, against] = topology_->edges.faces[e];
    const auto [from, to] = topology_->edges.vertices[e];
    const int change = facing_[along] - facing_[against];
    if (change != 0) add_outline(from, to, change);
  }
}

// Counts how many of the edges cross each row, and gives every row of a group as many places for them. Sets next_ to
// each row's first, returns how many crossings there are.
size_t OutlineSpans::group_rows(size_t num_edges) {
  const auto num_rows = static_cast<size_t>(rows_.count);
  const size_t num_groups = (num_rows + kGroupRows - 1) / kGroupRows;
  next_.assign(kGroupRows * num_groups + 1, 0);
  for (size_t e = 0; e < num_edges; ++e) {
    ++next_[static_cast<size_t>(row_begin_[e])];
    --next_[static_cast<size_t>(row_end_[e])];
  }
  groups_.resize(num_groups);
  uint32_t in_row = 0, places = 0;
  size_t total = 0;
  for (size_t g = 0; g < num_groups; ++g) {
    uint32_t most = 0;
    for (size_t row = kGroupRows * g; row < kGroupRows * (g + 1); ++row) {
      in_row += next_[row];
      total += in_row;
      most = std::max(most, in_row);
      next_[row] = static_cast<uint32_t>(kGroupRows) * places + static_cast<uint32_t>(row % kGroupRows);
    }
    groups_[g] = {places, most};
    places += most;
  }
  if (grouped_.size() < places) grouped_.resize(places);
  GroupCrossings none;
  std::ranges::fill(none.of_row, kSpareCrossing);
  std::fill_n(grouped_.begin(), places, none);
  return total;
}

void OutlineSpans::find_ends(size_t num_edges) {
  const size_t total = group_rows(num_edges);
  grow(crossings_, total);
  grow(crossing_row_, total);
  cross_rows(row_edges(), num_edges, rows_, crossings_.data(), crossing_row_.data());
  auto* const grouped = reinterpret_cast<Crossing*>(grouped_.data());
  for (size_t i = 0; i < total; ++i) {
    uint32_t& next = next_[static_cast<size_t>(crossing_row_[i])];
    grouped[next] = crossings_[i];
    next += static_cast<uint32_t>(kGroupRows);
  }
  grow(end_row_, total);
  grow(end_edge_, total);
  grow(end_x_, total);
  grow(end_side_, total);
  num_ends_ = find_span_ends(groups_.data(), groups_.size(), grouped_.data(),
                             {end_x_.data(), end_side_.data(), end_row_.data(), end_edge_.data()});
}

void OutlineSpans::scan(std::span<const Eigen::Vector2f> pixels, const SampledRows& rows, bool some_unseen) {
  check(pixels.size() >= topology_->num_vertices, "OutlineSpans: {} points for {} vertices", pixels.size(),
        topology_->num_vertices);
  rows_ = rows;
  if (some_unseen || topology_->faces.empty()) {
    find_outline_among_seen(pixels);
  } else {
    find_outline(pixels);
  }
  find_ends(find_row_edges({outline_from_.data(), outline_to_.data(), outline_change_.data()}, num_outline_,
                           pixels.data()->data(), rows_, row_edges()));
}

}  // namespace silpose
