#include "silpose/render/outline_edges.h"

#include <algorithm>

#include "silpose/base/check.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "silpose/render/outline_edges.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

// After highway.h.
#include "silpose/render/strip_edges-inl.h"

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

// Returns how many; from and to have room for 3 more.
size_t find_inner_edges(const StripView& strips, const GridPoint* HWY_RESTRICT point,
                        const uint8_t* HWY_RESTRICT winding, uint64_t* HWY_RESTRICT found, GridPoint* HWY_RESTRICT from,
                        GridPoint* HWY_RESTRICT to) {
  return find_strip_edges(strips, winding, found, [&](size_t i, size_t begin, size_t end) HWY_ATTR {
    from[i] = point[begin];
    to[i] = point[end];
  });
}

}  // namespace HWY_NAMESPACE
}  // namespace silpose
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace silpose {
namespace {

HWY_EXPORT(lay_strips);
HWY_EXPORT(find_inner_edges);

constexpr size_t kSpare = 16;  // the widest vector's: whole ones are read

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
  const StripOrder& strips = topology.strips;
  strip_points_.resize(strips.vertex.size());
  winding_.resize(strips.vertex.size() / 8 + kSpare);
  found_.resize(std::max(3 * (strips.runs.size() + 1), strips.pairs.size() + 1));
  inner_.from.resize(strips.num_inner_edges + kSpare);
  inner_.to.resize(strips.num_inner_edges + kSpare);
  border_.from.resize(topology.edges.faces.size() + kSpare);
  border_.to.resize(topology.edges.faces.size() + kSpare);
}

void OutlineEdges::find(std::span<const GridPoint> points, bool some_unseen, std::span<const Face> cut_faces) {
  check(points.size() >= topology_->num_vertices, "OutlineEdges: {} points for {} vertices", points.size(),
        topology_->num_vertices);
  inner_.count = border_.count = 0;
  if (!cut_faces.empty()) add_faces(points, cut_faces);
  if (topology_->faces.empty()) return;
  if (some_unseen) {
    find_among_seen(points);
    return;
  }
  const StripOrder& strips = topology_->strips;
  HWY_DYNAMIC_DISPATCH(lay_strips)
  (points.data(), strips.vertex.data(), strips.num_positions, strip_points_.data(), winding_.data());
  inner_.count = HWY_DYNAMIC_DISPATCH(find_inner_edges)(view_of(strips), strip_points_.data(), winding_.data(),
                                                        found_.data(), inner_.from.data(), inner_.to.data());
  for (const StripOrder::Border& border : strips.borders) {
    const size_t first = winding_[border.position / 8] >> (border.position % 8) & 1;
    push(border_, strip_points_[border.position + StripOrder::kSide[border.side][first]],
         strip_points_[border.position + StripOrder::kSide[border.side][first ^ 1]]);
  }
}

void OutlineEdges::find_among_seen(std::span<const GridPoint> points) {
  const std::vector<Face>& faces = topology_->faces;
  facing_.assign(faces.size() + 1, 0);  // the last is a missing neighbour
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

void OutlineEdges::add_faces(std::span<const GridPoint> points, std::span<const Face> faces) {
  const size_t room = topology_->edges.faces.size() + 3 * faces.size() + kSpare;
  if (border_.from.size() < room) {
    border_.from.resize(room);
    border_.to.resize(room);
  }
  for (const Face& face : faces) {
    check(std::max({face[0], face[1], face[2]}) < points.size(), "OutlineEdges: a cut face names a vertex of {}",
          points.size());
    const GridPoint a = points[face[0]], b = points[face[1]], c = points[face[2]];
    if (a.unseen() || b.unseen() || c.unseen()) continue;
    const bool turned = facing_of(a, b, c) < 0;
    push(border_, a, turned ? c : b);
    push(border_, turned ? c : b, turned ? b : c);
    push(border_, turned ? b : c, a);
  }
}

}  // namespace silpose
#endif  // HWY_ONCE
