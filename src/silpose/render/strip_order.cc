#include "silpose/render/strip_order.h"

#include <algorithm>
#include <tuple>

namespace silpose {
namespace {

using Neighbours = std::span<const std::array<int32_t, 3>>;

constexpr int32_t kNone = -1;

// One strip while it grows: its faces in order, and its vertices, two more.
struct Strip {
  std::vector<uint32_t> faces, vertices;
};

class StripBuilder {
 public:
  StripBuilder(std::span<const Face> faces, Neighbours neighbour)
      : faces_(faces), neighbour_(neighbour), position_(faces.size(), kNone), mark_(faces.size(), 0) {}

  // Calls take(strip) for strips that together hold every face once. position() is the caller's to set by place().
  template <class Take>
  void run(Take&& take) {
    // Faces by how many of their neighbours are left; an entry may be out of date and is then skipped.
    for (uint32_t f = 0; f < faces_.size(); ++f) by_neighbours_[neighbours_left(f)].push_back(f);
    for (;;) {
      const auto bucket = std::ranges::find_if(by_neighbours_, [](const auto& faces) { return !faces.empty(); });
      if (bucket == by_neighbours_.end()) return;
      const uint32_t seed = bucket->back();
      bucket->pop_back();
      const auto left = static_cast<size_t>(bucket - by_neighbours_.begin());
      if (position_[seed] != kNone || neighbours_left(seed) != left) continue;
      const Strip strip = longest_from(seed);
      take(strip);
      for (const uint32_t f : strip.faces) {
        for (const int32_t g : neighbour_[f]) {
          if (g != kNone && position_[static_cast<size_t>(g)] == kNone) {
            by_neighbours_[neighbours_left(static_cast<uint32_t>(g))].push_back(static_cast<uint32_t>(g));
          }
        }
      }
    }
  }

  void place(uint32_t face, size_t position) { position_[face] = static_cast<int32_t>(position); }
  [[nodiscard]] int32_t position(uint32_t face) const { return position_[face]; }

 private:
  [[nodiscard]] size_t neighbours_left(uint32_t f) const {
    return static_cast<size_t>(std::ranges::count_if(
        neighbour_[f], [&](int32_t g) { return g != kNone && position_[static_cast<size_t>(g)] == kNone; }));
  }

  // Extends a strip by the faces beyond `side` of its last face, as far as they are free.
  void extend(Strip& strip, uint32_t side) {
    for (;;) {
      const uint32_t f = strip.faces.back();
      const int32_t neighbour = neighbour_[f][side];
      if (neighbour == kNone) return;
      const auto g = static_cast<uint32_t>(neighbour);
      if (position_[g] != kNone || mark_[g] == stamp_) return;
      const uint32_t from = faces_[f][side], to = faces_[f][(side + 1) % 3];
      uint32_t entered = 0;
      while (entered < 3 && !(faces_[g][entered] == to && faces_[g][(entered + 1) % 3] == from)) ++entered;
      if (entered == 3) return;
      mark_[g] = stamp_;
      const uint32_t last = strip.vertices.back();
      strip.faces.push_back(g);
      strip.vertices.push_back(faces_[g][(entered + 2) % 3]);
      side = faces_[g][(entered + 1) % 3] == last ? (entered + 1) % 3 : (entered + 2) % 3;
    }
  }

  // The longest strip through a face: it may leave it by any two of its sides.
  Strip longest_from(uint32_t seed) {
    Strip longest;
    for (uint32_t k = 0; k < 3; ++k) {
      const uint32_t a = faces_[seed][k], b = faces_[seed][(k + 1) % 3], c = faces_[seed][(k + 2) % 3];
      mark_[seed] = ++stamp_;
      Strip strip{{seed}, {c, b, a}};
      extend(strip, k);  // beyond the side of a and b
      std::ranges::reverse(strip.faces);
      std::ranges::reverse(strip.vertices);
      extend(strip, (k + 1) % 3);  // beyond the side of b and c
      if (strip.faces.size() > longest.faces.size()) longest = std::move(strip);
    }
    return longest;
  }

  std::span<const Face> faces_;
  Neighbours neighbour_;
  std::vector<int32_t> position_;
  std::vector<uint32_t> mark_;
  uint32_t stamp_ = 0;
  std::array<std::vector<uint32_t>, 4> by_neighbours_;
};

// Whether a strip's neighbours that have their place run against it rather than along it. Edges of strips that run
// alike are a constant number of positions apart.
bool runs_against_neighbours(const Strip& strip, const StripBuilder& builder, Neighbours neighbour) {
  int along = 0, against = 0;
  for (size_t i = 2; i < strip.faces.size(); ++i) {
    for (const int32_t g : neighbour[strip.faces[i]]) {
      for (const int32_t h : neighbour[strip.faces[i - 2]]) {
        if (g == kNone || h == kNone) continue;
        const int32_t p = builder.position(static_cast<uint32_t>(g)), q = builder.position(static_cast<uint32_t>(h));
        if (p == kNone || q == kNone) continue;
        along += p == q + 2;
        against += p == q - 2;
      }
    }
  }
  return against > along;
}

struct InnerEdge {
  uint32_t first, other, side, expected;
  [[nodiscard]] uint32_t distance() const { return other - first; }
};

// The side of a triangle, in its strip order, that joins two vertices; and 1 where it winds as the strip order does
// not.
std::pair<uint32_t, uint32_t> strip_side(std::span<const uint32_t> triangle, uint32_t a, uint32_t b) {
  for (uint32_t s = 0; s < 3; ++s) {
    const uint32_t from = triangle[StripOrder::kSide[s][0]], to = triangle[StripOrder::kSide[s][1]];
    if (from == a && to == b) return {s, 0u};
  }
  for (uint32_t s = 0; s < 3; ++s) {
    const uint32_t from = triangle[StripOrder::kSide[s][0]], to = triangle[StripOrder::kSide[s][1]];
    if (from == b && to == a) return {s, 1u};
  }
  return {0u, 0u};
}

// The edges between two faces, in the order of runs. Edges of one face go to the order's borders.
std::vector<InnerEdge> find_edges(std::span<const Face> faces, Neighbours neighbour, const StripBuilder& builder,
                                  StripOrder& order) {
  const auto triangle = [&](uint32_t position) { return std::span(order.vertex).subspan(position, 3); };
  std::vector<InnerEdge> inner;
  for (uint32_t f = 0; f < faces.size(); ++f) {
    const auto p = static_cast<uint32_t>(builder.position(f));
    for (uint32_t side = 0; side < 3; ++side) {
      const uint32_t a = faces[f][side], b = faces[f][(side + 1) % 3];
      const auto [s, turned] = strip_side(triangle(p), a, b);
      if (neighbour[f][side] == kNone) {
        order.borders.push_back({p, s});
        continue;
      }
      const auto q = static_cast<uint32_t>(builder.position(static_cast<uint32_t>(neighbour[f][side])));
      if (p >= q) continue;  // the other face's turn
      inner.push_back({p, q, s, turned ^ strip_side(triangle(q), b, a).second});
    }
  }
  std::ranges::sort(inner, {}, [](const InnerEdge& e) { return std::tuple(e.distance(), e.side, e.first); });
  return inner;
}

// Puts the edges of equal distance and side into runs, and those that are left into pairs.
void gather_runs(std::span<const InnerEdge> inner, StripOrder& order) {
  constexpr size_t kFewest = 2;  // a run costs as much as this many pairs
  for (size_t begin = 0, end = 0; begin < inner.size(); begin = end) {
    const InnerEdge& head = inner[begin];
    StripOrder::Run run{.first = head.first & ~7u, .side = head.side};
    run.other = run.first + head.distance();
    for (end = begin; end < inner.size() && inner[end].distance() == head.distance() && inner[end].side == head.side &&
                      inner[end].first < run.first + StripOrder::kRunLength;
         ++end) {
      const uint64_t bit = uint64_t{1} << (inner[end].first - run.first);
      run.mask |= bit;
      if (inner[end].expected != 0) run.expected |= bit;
    }
    if (end - begin >= kFewest) {
      order.runs.push_back(run);
      continue;
    }
    for (const InnerEdge& edge : inner.subspan(begin, end - begin)) {
      order.pairs.push_back({edge.first << 2 | edge.side, edge.other << 1 | edge.expected});
    }
  }
}

}  // namespace

StripOrder::StripOrder(std::span<const Face> faces, Neighbours neighbour) {
  StripBuilder builder(faces, neighbour);
  builder.run([&](const Strip& grown) {
    Strip strip = grown;
    if (runs_against_neighbours(strip, builder, neighbour)) {
      std::ranges::reverse(strip.faces);
      std::ranges::reverse(strip.vertices);
    }
    for (size_t i = 0; i < strip.faces.size(); ++i) builder.place(strip.faces[i], vertex.size() + i);
    vertex.insert(vertex.end(), strip.vertices.begin(), strip.vertices.end());
  });
  num_positions = (vertex.size() + 63) / 64 * 64;
  vertex.resize(num_positions + kPadding, vertex.empty() ? 0 : vertex.back());
  const std::vector<InnerEdge> inner = find_edges(faces, neighbour, builder, *this);
  num_inner_edges = inner.size();
  gather_runs(inner, *this);
}

}  // namespace silpose
