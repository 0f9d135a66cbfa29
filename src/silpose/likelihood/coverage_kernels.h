// What CoverageDifference spends its time on, for whatever vector registers the machine has (chosen at run time): the
// blur, and the products of a Jacobian whose rows are cells. Numbers beyond what is asked for may be written where a
// size is rounded up to AlignedFloats::kLanes.
// Threads: pure functions.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace silpose {

// G * G along one axis, sigma one cell, at 0, 1, ... kBlurRadius cells; sums to 1 over both sides. Beyond, exp(-d^2 /
// 4) is below 0.2 % of the peak.
inline constexpr int kBlurRadius = 4;
extern const std::array<float, kBlurRadius + 1> kBlurKernel;

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

// An end of a span in a cell: what it adds to the cell's row, of the two rows (pixel x, then y) of each of two points.
struct EndRow {
  uint32_t points[2];
  float of_x[2], of_y[2];
};

// jacobian [cells, stride] = what the ends of each cell, up to ends_end[cell], add up to; point_rows [points, 2,
// stride].
void add_up_ends(const EndRow* ends, const uint32_t* ends_end, size_t num_cells, const float* point_rows, size_t stride,
                 float* jacobian);

// half_near [n, stride] = for each row i of `jacobian` [n, stride], K_ii / 2 J_i + sum over j > i of K_ij J_j, so that
// J' K J = M + M' with M = J' half_near. REQUIRES: rows aligned, stride a multiple of kLanes.
void add_near_rows(const EndCells& cells, const float* jacobian, size_t stride, float* half_near);

// product [rounded up to 4 rows, stride] = the first `num_columns` columns of a, transposed, times b; a, b [n, stride].
// REQUIRES: as above.
void transposed_product(const float* a, const float* b, size_t n, size_t stride, size_t num_columns, float* product);

}  // namespace silpose
