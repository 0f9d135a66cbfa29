// The loops of OutlineSpans, by Highway: built for every instruction set and chosen at run time. Whole vectors are read
// and written: every array has kSpanSpare numbers to spare. Threads: pure functions.
#pragma once

#include <cstddef>
#include <cstdint>

#include "silpose/render/strip_view.h"

namespace silpose {

inline constexpr size_t kSpanSpare = 16;

// Rows y = first + r * step, r = 0 .. count - 1, in image pixels.
struct SampledRows {
  float first = 0, step = 1;
  int count = 0;
};

// Edges whose two faces are turned to different sides, or that have one only: crossing one where it runs down, the
// winding number changes by this much.
struct OutlineList {
  uint32_t *from, *to;
  int32_t* change;
};

// Edges of the outline that cross rows: vertex a above b, the rows they cross, and the change to the right of them.
struct RowEdges {
  int32_t *vertex_a, *vertex_b, *change, *row_begin, *row_end;
  float *top_x, *top_y, *dx_dy, *inverse_height;
};

// Rows are handled side by side, in groups.
inline constexpr size_t kGroupRows = 8;

// A crossing is one number, so that sorting moves little: x in the upper half, as an integer of the same order; then
// the edge; then the change, plus 2, in the lowest four bits. Spare ones are the largest, and change nothing.
using Crossing = int64_t;
inline constexpr Crossing kSpareCrossing = INT64_MAX - 0xf + 2;
struct alignas(sizeof(Crossing) * kGroupRows) GroupCrossings {
  Crossing of_row[kGroupRows];
};
struct RowGroup {
  uint32_t first = 0, count = 0;  // its crossings; every row has as many, spare ones last
};

// Where spans begin (side 1) and end (side -1).
struct SpanEnds {
  const float *x, *side;  // x in image pixels
  const int32_t *row, *edge;
  size_t count = 0;
};
struct EndLists {
  float *x, *side;
  int32_t *row, *edge;
};

// One bit per position: whether the strip order of its triangle winds anticlockwise on the screen. `pixels`: x and y
// alternating; `vertex` is StripOrder's.
void find_winding(const float* pixels, const uint32_t* vertex, size_t num_positions, uint8_t* winding);

// The edges between two faces; sets `from` and `to`, returns how many. `found` as find_strip_edges() has it.
size_t find_inner_outline(const StripView& strips, const uint32_t* vertex, const uint8_t* winding, uint64_t* found,
                          const OutlineList& outline);

// Those of `count` edges that cross rows; returns how many.
size_t find_row_edges(const OutlineList& outline, size_t count, const float* pixels, const SampledRows& rows,
                      const RowEdges& edges);

// All crossings, edge by edge, and their rows; returns how many.
size_t cross_rows(const RowEdges& edges, size_t count, const SampledRows& rows, Crossing* crossings, int32_t* row);

// Sorts the crossings of every row and finds the ends of its spans; returns how many.
size_t find_span_ends(const RowGroup* groups, size_t num_groups, GroupCrossings* crossings, const EndLists& ends);

}  // namespace silpose
