// The Jacobian of CoverageDifference and its products, for the machine's vector registers (chosen at run time). Rows
// are cells that hold an end, columns come in blocks of kLanes; a cell near a leg has nothing in the block of the arms,
// so every cell has one bit per block that is set where it is not zero.
// Threads: pure functions. REQUIRES everywhere: rows aligned, `stride` a multiple of AlignedFloats::kLanes.
#pragma once

#include <cstddef>
#include <cstdint>

namespace silpose {

// Cells that hold an end, in row-major order; a few more of each number can be read.
struct EndCells {
  const int32_t *x, *y;   // [n]
  const int32_t* blocks;  // [n] of the Jacobian's row
  size_t count = 0;
  // rank[y * rank_stride + x] is how many come before cell (x, y); it can be read kBlurRadius + 1 cells to either side,
  // in rows below `y_end`.
  const int32_t* rank;
  ptrdiff_t rank_stride;
  int32_t y_end;
};

// How points of the surface move: two rows each (pixel x, then y), and the blocks where they are not zero.
struct PointRows {
  const float* rows;      // [points, 2, stride]
  const int32_t* blocks;  // [points]
};

// An end of a span: what it adds to its cell's row, of the two rows of each of two points.
struct EndRow {
  uint32_t cell;
  uint32_t points[2];
  float of_x[2], of_y[2];
};

// jacobian [cells, stride] and blocks [cells] = what the ends of each cell add up to.
void add_up_ends(const EndRow* ends, size_t num_ends, const PointRows& points, size_t stride, size_t num_cells,
                 float* jacobian, int32_t* blocks);

// half_near [n, stride] = for each row i of `jacobian` [n, stride], K_ii / 2 J_i + sum over j > i of K_ij J_j, so that
// J' K J = M + M' with M = J' half_near. near_blocks [n]: where it is not zero.
void add_near_rows(const EndCells& cells, const float* jacobian, size_t stride, float* half_near, int32_t* near_blocks);

// A matrix [n, stride], and for each of its blocks which rows are not zero there: one bit per row, [blocks, words].
struct SparseRows {
  const float* rows;
  const uint64_t* bits;
};

// Sets the bits of rows [n] from their blocks.
void find_bits(const int32_t* blocks, size_t n, size_t num_blocks, uint64_t* bits);
[[nodiscard]] constexpr size_t words_of_bits(size_t n) { return (n + 63) / 64; }

// product [stride, stride] = a, transposed, times b; a, b [n, stride].
void transposed_product(const SparseRows& a, const SparseRows& b, size_t n, size_t stride, float* product);

// sum [stride] of weight [n] times the rows of a.
void weighted_sum(const float* a, const float* weight, size_t n, size_t stride, float* sum);

}  // namespace silpose
