// StripOrder: a mesh's faces as triangle strips, and its edges as pairs of strip positions in long regular runs, so
// that vector instructions can find the outline without a lookup per face. Position p is the triangle of the strip
// vertices p, p + 1, p + 2; two positions between strips are no triangle. Based on: triangle strips grown greedily from
// the faces with the fewest neighbours left (references.bib: evans1996). Threads: a value; made once per mesh.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "silpose/geometry/mesh.h"

namespace silpose {

struct StripOrder {
  StripOrder() = default;
  // `neighbour` [F] as EdgeTopology has it.
  StripOrder(std::span<const Face> faces, std::span<const std::array<int32_t, 3>> neighbour);

  // Vertices past the last position may be read as if there were this many more; they repeat the last.
  static constexpr size_t kPadding = 80;

  std::vector<uint32_t> vertex;  // [num_positions + kPadding]
  size_t num_positions = 0;      // a multiple of 64

  // A triangle's sides, in its strip order: from position + kSide[s][0] to position + kSide[s][1].
  static constexpr std::array<std::array<uint8_t, 2>, 3> kSide = {{{0, 1}, {1, 2}, {2, 0}}};

  // Edges between positions first + b and other + b, for the bits b that are set in `mask`. The two faces are turned to
  // the same side when bit b of `expected` says whether their strip orders wind differently on the screen.
  struct Run {
    uint64_t mask = 0, expected = 0;
    uint32_t first = 0, other = 0;  // first is a multiple of 8
    uint32_t side = 0;              // of the triangle at `first`
  };
  static constexpr uint32_t kRunLength = 56;  // so that a word that begins at any bit of a byte holds a run
  std::vector<Run> runs;

  // Edges that are in no run.
  struct Pair {
    uint32_t first_and_side = 0, other_and_expected = 0;  // position << 2 | side, position << 1 | expected
    [[nodiscard]] uint32_t first() const { return first_and_side >> 2; }
    [[nodiscard]] uint32_t other() const { return other_and_expected >> 1; }
  };
  std::vector<Pair> pairs;

  // Edges of one face only.
  struct Border {
    uint32_t position = 0, side = 0;
  };
  std::vector<Border> borders;

  // An upper bound of how many edges any outline has, borders left out.
  size_t num_inner_edges = 0;
};

}  // namespace silpose
