#include "silpose/render/outline_spans.h"

#include <algorithm>
#include <utility>

#include "silpose/base/check.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "silpose/render/outline_spans.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

// After highway.h.
#include "silpose/render/strip_edges-inl.h"

HWY_BEFORE_NAMESPACE();
namespace silpose::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// One bit a position: whether the strip order of its triangle winds anticlockwise on the screen. `xy`: of the strip's
// points, in turns; read a vector's length beyond the last.
void find_winding_of_floats(const float* HWY_RESTRICT xy, size_t num_positions, uint8_t* HWY_RESTRICT winding) {
#if HWY_TARGET == HWY_SCALAR
  for (size_t p = 0; p < num_positions; p += 8) {
    uint32_t bits = 0;
    for (size_t i = 0; i < 8; ++i) {
      const float* const a = xy + 2 * (p + i);
      bits |= static_cast<uint32_t>((a[2] - a[0]) * (a[5] - a[1]) < (a[3] - a[1]) * (a[4] - a[0])) << i;
    }
    winding[p / 8] = static_cast<uint8_t>(bits);
  }
#else
  const hn::CappedTag<float, 16> d;
  const hn::Repartition<int64_t, decltype(d)> d64;
  constexpr size_t kPositions = hn::MaxLanes(hn::CappedTag<float, 16>()) / 2;
  for (size_t p = 0; p < num_positions; p += 8) {
    uint32_t bits = 0;
    for (size_t i = 0; i < 8; i += kPositions) {
      const float* const at = xy + 2 * (p + i);
      const auto a = hn::LoadU(d, at);
      const auto ab = hn::Sub(hn::LoadU(d, at + 2), a), ac = hn::Sub(hn::LoadU(d, at + 4), a);
      const auto products = hn::Mul(ab, hn::Shuffle2301(ac));  // ab.x ac.y, ab.y ac.x
      const auto is_less = hn::VecFromMask(d, hn::Lt(hn::Shuffle2301(products), products));
      uint8_t mask[8];
      hn::StoreMaskBits(d64, hn::MaskFromVec(hn::BitCast(d64, hn::DupOdd(is_less))), mask);
      bits |= static_cast<uint32_t>(mask[0]) << i;
    }
    winding[p / 8] = static_cast<uint8_t>(bits);
  }
#endif
}

// Returns how many; `outline` has room for 3 more. `vertex` is StripOrder's.
size_t find_inner_outline(const StripView& strips, const uint32_t* HWY_RESTRICT vertex,
                          const uint8_t* HWY_RESTRICT winding, uint64_t* HWY_RESTRICT found,
                          OutlineSpans::OutlineEdge* HWY_RESTRICT outline) {
  return find_strip_edges(strips, winding, found, [&](size_t i, size_t begin, size_t end) HWY_ATTR {
    outline[i] = {vertex[begin], vertex[end], 2};
  });
}

}  // namespace silpose::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
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

HWY_EXPORT(find_winding_of_floats);
HWY_EXPORT(find_inner_outline);

OutlineSpans::OutlineSpans(const EdgeTopology& topology) : topology_(&topology) {
  constexpr size_t kSpare = 16;  // the widest vector's: whole ones are read, and lists are written longer than they are
  const StripOrder& strips = topology.strips;
  strip_points_.resize(strips.vertex.size());
  winding_.resize(strips.vertex.size() / 8 + kSpare);
  found_.resize(std::max(3 * (strips.runs.size() + 1), strips.pairs.size() + 1));
  outline_.resize(std::max(strips.num_inner_edges + strips.borders.size(), topology.edges.faces.size()) + kSpare);
  edges_.resize(outline_.size());
}

// As OutlineEdges finds it, in floating point: strips in place of faces, long runs of edges in place of single ones.
void OutlineSpans::find_outline(std::span<const Eigen::Vector2f> pixels) {
  const StripOrder& strips = topology_->strips;
  for (size_t i = 0; i < strip_points_.size(); ++i) strip_points_[i] = pixels[strips.vertex[i]];
  HWY_DYNAMIC_DISPATCH(find_winding_of_floats)(strip_points_.data()->data(), strips.num_positions, winding_.data());

  num_outline_ = HWY_DYNAMIC_DISPATCH(find_inner_outline)(view_of(strips), strips.vertex.data(), winding_.data(),
                                                          found_.data(), outline_.data());
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

// Edges of the outline that cross rows, into edges_; counts the crossings of each row into row_start_.
size_t OutlineSpans::find_edges(std::span<const Eigen::Vector2f> pixels) {
  const float rows_per_pixel = 1 / rows_.step, row_count = static_cast<float>(rows_.count);
  row_start_.assign(static_cast<size_t>(rows_.count) + 1, 0);
  size_t num_kept = 0;
  for (size_t i = 0; i < num_outline_; ++i) {
    const auto [from, to, change] = outline_[i];
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

void OutlineSpans::scan(std::span<const Eigen::Vector2f> pixels, const SampledRows& rows, bool some_unseen) {
  check(pixels.size() >= topology_->num_vertices, "OutlineSpans: {} points for {} vertices", pixels.size(),
        topology_->num_vertices);
  rows_ = rows;
  if (some_unseen || topology_->faces.empty()) {
    find_outline_among_seen(pixels);
  } else {
    find_outline(pixels);
  }
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
#endif  // HWY_ONCE
