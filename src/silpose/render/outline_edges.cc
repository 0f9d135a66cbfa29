#include "silpose/render/outline_edges.h"

#include <algorithm>
#include <cstring>

#include "silpose/base/check.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "silpose/render/outline_edges.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef SILPOSE_RENDER_OUTLINE_EDGES_TYPES
#define SILPOSE_RENDER_OUTLINE_EDGES_TYPES
namespace silpose {
namespace {

// What the kernels see: nothing but pointers, so that no code of a library is compiled for one instruction set only.
struct StripView {
  const StripOrder::Run* runs;
  size_t num_runs;
  const StripOrder::Pair* pairs;
  size_t num_pairs;
};

uint64_t load_word(const uint8_t* bytes) {
  uint64_t word;
  std::memcpy(&word, bytes, sizeof word);
  return word;
}

}  // namespace
}  // namespace silpose
#endif

HWY_BEFORE_NAMESPACE();
namespace silpose {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Triangles [begin, end) of the strips, both multiples of 8, one bit each: whether the strip order winds anticlockwise
// on the screen.
HWY_INLINE void find_winding(const GridPoint* HWY_RESTRICT point, size_t begin, size_t end,
                             uint8_t* HWY_RESTRICT winding) {
#if HWY_TARGET == HWY_SCALAR
  for (size_t p = begin; p < end; p += 8) {
    uint32_t bits = 0;
    for (size_t i = 0; i < 8; ++i) {
      const GridPoint a = point[p + i], b = point[p + i + 1], c = point[p + i + 2];
      const bool anticlockwise = int64_t{b.x - a.x} * (c.y - a.y) < int64_t{b.y - a.y} * (c.x - a.x);
      bits |= static_cast<uint32_t>(anticlockwise) << i;
    }
    winding[p / 8] = static_cast<uint8_t>(bits);
  }
#else
  const hn::CappedTag<int64_t, 8> d64;
  const hn::Repartition<int32_t, decltype(d64)> d32;
  constexpr size_t kLanes = hn::MaxLanes(hn::CappedTag<int64_t, 8>());
  const int32_t* const xy = &point->x;
  for (size_t p = begin; p < end; p += 8) {
    uint32_t bits = 0;
    for (size_t i = 0; i < 8; i += kLanes) {
      const auto a = hn::LoadU(d32, xy + 2 * (p + i));
      const auto ab = hn::Sub(hn::LoadU(d32, xy + 2 * (p + i + 1)), a);
      const auto ac = hn::Sub(hn::LoadU(d32, xy + 2 * (p + i + 2)), a);
      // Even lanes are x; with x and y exchanged they are y.
      const auto smaller = hn::Lt(hn::MulEven(ab, hn::Shuffle2301(ac)), hn::MulEven(hn::Shuffle2301(ab), ac));
      uint8_t mask[8];
      hn::StoreMaskBits(d64, smaller, mask);
      bits |= static_cast<uint32_t>(mask[0]) << i;
    }
    winding[p / 8] = static_cast<uint8_t>(bits);
  }
#endif
}

// Copies the points into strip order, and finds the winding of what was just copied, while it is near.
void lay_strips(const GridPoint* HWY_RESTRICT points, const uint32_t* HWY_RESTRICT vertex, size_t num_positions,
                GridPoint* HWY_RESTRICT strip_points, uint8_t* HWY_RESTRICT winding) {
  constexpr size_t kBlock = 512, kAhead = StripOrder::kPadding;  // a vector of triangles needs two vertices beyond it
  size_t copied = 0;
  for (size_t begin = 0; begin < num_positions; begin += kBlock) {
    const size_t end = HWY_MIN(begin + kBlock, num_positions);
    for (; copied < end + kAhead; ++copied) strip_points[copied] = points[vertex[copied]];
    find_winding(strip_points, begin, end, winding);
  }
}

// The edges between two faces that are turned to different sides. Returns how many; from and to have room for 3 more.
// Free of branches that depend on the data, but for runs with more than four of them: neither is predictable.
size_t find_inner_edges(const StripView& strips, const GridPoint* HWY_RESTRICT point,
                        const uint8_t* HWY_RESTRICT winding, uint64_t* HWY_RESTRICT found, GridPoint* HWY_RESTRICT from,
                        GridPoint* HWY_RESTRICT to) {
  constexpr uint64_t kNoneLeft = uint64_t{1} << 63;  // no run is as long
  size_t num_found = 0;
  for (size_t r = 0; r < strips.num_runs; ++r) {
    const StripOrder::Run& run = strips.runs[r];
    const uint64_t first = load_word(winding + run.first / 8);
    const uint64_t other = load_word(winding + run.other / 8) >> (run.other % 8);
    const uint64_t differ = (first ^ other ^ run.expected) & run.mask;
    found[3 * num_found] = differ;
    found[3 * num_found + 1] = first;
    found[3 * num_found + 2] = r;
    num_found += static_cast<size_t>(differ != 0);
  }
  size_t count = 0;
  for (size_t f = 0; f < num_found; ++f) {
    uint64_t differ = found[3 * f];
    const uint64_t first = found[3 * f + 1];
    const StripOrder::Run& run = strips.runs[found[3 * f + 2]];
    const GridPoint* const start = point + run.first + StripOrder::kSide[run.side][0];
    const auto along = static_cast<int64_t>(StripOrder::kSide[run.side][1]) - StripOrder::kSide[run.side][0];
    const size_t end = count + hwy::PopCount(differ);
    do {
      for (size_t i = 0; i < 4; ++i) {
        const auto bit = static_cast<uint32_t>(__builtin_ctzll(differ | kNoneLeft));  // read, not kept
        const int64_t turned = -static_cast<int64_t>(first >> bit & 1);
        from[count + i] = start[bit + (along & turned)];
        to[count + i] = start[bit + (along & ~turned)];
        differ &= differ - 1;
      }
      count += 4;
    } while (count < end);
    count = end;
  }
  size_t num_pairs = 0;
  for (size_t i = 0; i < strips.num_pairs; ++i) {
    const StripOrder::Pair pair = strips.pairs[i];
    const uint32_t first = pair.first(), other = pair.other();
    const uint32_t first_winding = winding[first / 8] >> (first % 8) & 1;
    const uint32_t other_winding = winding[other / 8] >> (other % 8);
    found[num_pairs] = uint64_t{pair.first_and_side} << 1 | first_winding;
    num_pairs += (first_winding ^ other_winding ^ pair.other_and_expected) & 1;
  }
  for (size_t i = 0; i < num_pairs; ++i) {
    const uint64_t turned = found[i] & 1, side = found[i] >> 1 & 3, first = found[i] >> 3;
    from[count] = point[first + StripOrder::kSide[side][turned]];
    to[count++] = point[first + StripOrder::kSide[side][turned ^ 1]];
  }
  return count;
}

}  // namespace HWY_NAMESPACE
}  // namespace silpose
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace silpose {
namespace {

HWY_EXPORT(lay_strips);
HWY_EXPORT(find_inner_edges);

// 1 for triangles that wind clockwise on the screen or have no area, -1 for the others.
int8_t facing_of(GridPoint a, GridPoint b, GridPoint c) {
  return int64_t{b.x - a.x} * (c.y - a.y) < int64_t{b.y - a.y} * (c.x - a.x) ? int8_t{-1} : int8_t{1};
}

void push(OutlineEdges::Edges& edges, GridPoint from, GridPoint to) {
  edges.from[edges.count] = from;
  edges.to[edges.count++] = to;
}

}  // namespace

static_assert(sizeof(GridPoint) == 2 * sizeof(int32_t));  // x and y in turns

OutlineEdges::OutlineEdges(const EdgeTopology& topology) : topology_(&topology) {
  constexpr size_t kSpare = 16;  // the widest vector's: whole ones are read
  const StripOrder& strips = topology.strips;
  strip_points_.resize(strips.vertex.size());
  winding_.resize(strips.vertex.size() / 8 + kSpare);
  found_.resize(std::max(3 * (strips.runs.size() + 1), strips.pairs.size() + 1));
  inner_.from.resize(strips.num_inner_edges + kSpare);
  inner_.to.resize(strips.num_inner_edges + kSpare);
  border_.from.resize(topology.edges.faces.size() + kSpare);
  border_.to.resize(topology.edges.faces.size() + kSpare);
}

void OutlineEdges::find(std::span<const GridPoint> points, bool some_unseen) {
  check(points.size() >= topology_->num_vertices, "OutlineEdges: {} points for {} vertices", points.size(),
        topology_->num_vertices);
  inner_.count = border_.count = 0;
  if (topology_->faces.empty()) return;
  if (some_unseen) {
    find_among_seen(points);
    return;
  }
  const StripOrder& strips = topology_->strips;
  HWY_DYNAMIC_DISPATCH(lay_strips)
  (points.data(), strips.vertex.data(), strips.num_positions, strip_points_.data(), winding_.data());
  const StripView view{.runs = strips.runs.data(),
                       .num_runs = strips.runs.size(),
                       .pairs = strips.pairs.data(),
                       .num_pairs = strips.pairs.size()};
  inner_.count = HWY_DYNAMIC_DISPATCH(find_inner_edges)(view, strip_points_.data(), winding_.data(), found_.data(),
                                                        inner_.from.data(), inner_.to.data());
  for (const StripOrder::Border& border : strips.borders) {
    const size_t first = winding_[border.position / 8] >> (border.position % 8) & 1;
    push(border_, strip_points_[border.position + StripOrder::kSide[border.side][first]],
         strip_points_[border.position + StripOrder::kSide[border.side][first ^ 1]]);
  }
}

void OutlineEdges::find_among_seen(std::span<const GridPoint> points) {
  const std::vector<Face>& faces = topology_->faces;
  facing_.assign(faces.size() + 1, 0);  // the last stands for a missing neighbour
  for (size_t f = 0; f < faces.size(); ++f) {
    const GridPoint a = points[faces[f][0]], b = points[faces[f][1]], c = points[faces[f][2]];
    if (!a.unseen() && !b.unseen() && !c.unseen()) facing_[f] = facing_of(a, b, c);
  }
  for (size_t e = 0; e < topology_->edges.faces.size(); ++e) {
    const auto [along, against] = topology_->edges.faces[e];
    const auto [from, to] = topology_->edges.vertices[e];
    const int change = facing_[along] - facing_[against];
    if (change == 0) continue;
    push(change == 2 || change == -2 ? inner_ : border_, points[change > 0 ? from : to],
         points[change > 0 ? to : from]);
  }
}

}  // namespace silpose
#endif  // HWY_ONCE
