// The cells of CoverageDifference, for the machine's vector registers (chosen at run time). More numbers than requested
// may be written where a size is rounded up to AlignedFloats::kLanes. Threads: pure functions.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "silpose/render/span_kernels.h"

namespace silpose {

// G * G along one axis, sigma one cell, at 0, 1, ... kBlurRadius cells; sums to 1 over both sides. Beyond, exp(-d^2 /
// 4) is below 0.2 % of the peak. [definition]
inline constexpr int kBlurRadius = 4;
extern const std::array<float, kBlurRadius + 1> kBlurKernel;

// Cells [x0, x1) by [y0, y1).
struct CellBox {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

// Cells of an image, and the layout of arrays over them.
struct CellGrid {
  float image_width = 0;  // pixels
  float cells_per_pixel = 1, cells_per_row = 1;
  int32_t last_x = 0;
  int32_t stride = 0, margin = 0;  // as CoverageDifference::at()
};

// Of each end of a span: its cell, x = -1 for ends outside of the image; its place; by how much it changes the
// coverage from its cell on, and how much more from the next.
struct PlacedEnds {
  int32_t *x, *y, *at;
  float *here, *beyond;
};

// Returns the box of cells that ends lie in. REQUIRES: an end; kSpanSpare to spare in every array.
CellBox place_ends(const SpanEnds& ends, const CellGrid& grid, const PlacedEnds& placed);

// Columns of cells, each `stride` apart. confidence: nullptr for 1 everywhere.
struct ObservedCells {
  const float *observed, *confidence;
  size_t stride;
};

// difference [width, stride]: columns in which every cell holds by how much the coverage changes from its left
// neighbour to it. Makes of it the coverage, less the observed, times confidence. Up to kLanes below a column are
// written: zeros, where they and the observed ones were.
void subtract_observed(const ObservedCells& cells, float* difference, size_t stride, size_t height, size_t width);

// blurred = K * D on a box of cells outside of which D is zero; gives D' K D. K is the same along both axes: rows may
// be columns. Rows of D are `stride` apart, and can be read, as zeros, kBlurRadius to the left of the box and
// kBlurRadius + kLanes to its right. Rows of `half` (scratch) and `blurred` are padded(width) apart and aligned.
double blur_cells(const float* difference, size_t stride, size_t width, size_t height, float* half, float* blurred);

// Cells that hold an end, one after another.
struct NumberedCells {
  int32_t *x, *y;
  size_t* count;
};

// Numbers the cells of row y that hold an end, one bit per cell in `bits`. Writes, for every cell of the box's row and
// `margin` beyond, how many come before it: rank[x]. Up to kLanes more are written.
void number_row(const uint64_t* bits, const CellBox& box, int y, int margin, int32_t* rank, const NumberedCells& cells);

}  // namespace silpose
