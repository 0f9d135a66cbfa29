// What CoverageDifference spends its time on, for whatever vector registers the machine has (chosen at run time): the
// blur, and the products of a Jacobian whose rows are cells. Numbers beyond what is asked for may be written where a
// size is rounded up to AlignedFloats::kLanes.
// Threads: pure functions.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "silpose/render/span_kernels.h"

namespace silpose {

// G * G along one axis, sigma one cell, at 0, 1, ... kBlurRadius cells; sums to 1 over both sides. Beyond, exp(-d^2 /
// 4) is below 0.2 % of the peak.
inline constexpr int kBlurRadius = 4;
extern const std::array<float, kBlurRadius + 1> kBlurKernel;

// Cells [x0, x1) by [y0, y1).
struct CellBox {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

// Cells of a picture, and where what is known of them lies.
struct CellGrid {
  float picture_width = 0;  // pixels
  float cells_per_pixel = 1, cells_per_row = 1;
  int32_t last_x = 0;
  int32_t stride = 0, rank_stride = 0, margin = 0;  // as CoverageDifference::at() and rank_at()
};

// Of each end of a span: the place of its cell, and of what is kept by row, -1 for ends outside of the picture; by how
// much it changes the coverage from its cell on, and how much more from the next.
struct PlacedEnds {
  int32_t *at, *rank_at;
  float *here, *beyond;
};

// Returns the cells that ends lie in, with the column after them. REQUIRES: ends, and kSpanSpare to spare in arrays.
CellBox place_ends(const SpanEnds& ends, const CellGrid& grid, const PlacedEnds& placed);

// Columns of cells, each `stride` apart. confidence: nullptr for 1 everywhere.
struct ObservedCells {
  const float *observed, *confidence;
  size_t stride;
};

// difference [width, stride], where every cell holds what changes from its left: summed up, less what is observed,
// times confidence. Up to kLanes below each column are overwritten with what is 0 when they are, and the observed too.
void subtract_observed(const ObservedCells& cells, float* difference, size_t stride, size_t height, size_t width);

// blurred = K * D on a box of cells outside of which D is zero; gives D' K D. Rows of D are `stride` apart, and can be
// read, as zeros, kBlurRadius to the left of the box and kBlurRadius + kLanes to its right. Rows of `half` (scratch)
// and `blurred` are padded(width) apart and aligned.
double blur_cells(const float* difference, size_t stride, size_t width, size_t height, float* half, float* blurred);

// Cells that hold an end, in row-major order.
struct EndCells {
  const int32_t *x, *y;  // [n]
  size_t count = 0;
  // rank[y * rank_stride + x] is how many come before cell (x, y); it can be read kBlurRadius + 1 cells to either side,
  // in rows below `y_end`.
  const int32_t* rank;
  ptrdiff_t rank_stride;
  int32_t y_end;
};

// An end of a span: what it adds to its cell's row, of the two rows (pixel x, then y) of each of two points.
struct EndRow {
  uint32_t cell;
  uint32_t points[2];
  float of_x[2], of_y[2];
};

// jacobian [cells, stride] = what the ends of each cell add up to; point_rows [points, 2, stride].
void add_up_ends(const EndRow* ends, size_t num_ends, const float* point_rows, size_t stride, size_t num_cells,
                 float* jacobian);

// half_near [n, stride] = for each row i of `jacobian` [n, stride], K_ii / 2 J_i + sum over j > i of K_ij J_j, so that
// J' K J = M + M' with M = J' half_near. REQUIRES: rows aligned, stride a multiple of kLanes.
void add_near_rows(const EndCells& cells, const float* jacobian, size_t stride, float* half_near);

// product [rounded up to 4 rows, stride] = the first `num_columns` columns of a, transposed, times b; a, b [n, stride].
// REQUIRES: as above.
void transposed_product(const float* a, const float* b, size_t n, size_t stride, size_t num_columns, float* product);

}  // namespace silpose
