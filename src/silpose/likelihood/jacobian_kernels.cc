#include "silpose/likelihood/jacobian_kernels.h"

#include <cstdlib>

#include "silpose/base/aligned_floats.h"
#include "silpose/likelihood/coverage_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "silpose/likelihood/jacobian_kernels.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace silpose::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<float, AlignedFloats::kLanes>;
using Vector = hn::Vec<Tag>;

// [definition] Layout of blocks and cells.
constexpr size_t kBlock = AlignedFloats::kLanes;
constexpr int32_t kSide = 2 * kBlurRadius + 1;  // cells that a cell's blur reaches along a row
constexpr int32_t kNoWeight = (kBlurRadius + 1) * kSide;
constexpr size_t kAtOnce = 4;  // cells that are listed at once

void add_up_ends(const EndRow* ends, size_t num_ends, const PointRows& points, size_t stride, size_t num_cells,
                 float* HWY_RESTRICT jacobian, int32_t* HWY_RESTRICT blocks) {
  const Tag d;
  const size_t lanes = hn::Lanes(d);
  for (size_t i = 0; i < num_cells; ++i) blocks[i] = 0;
  for (size_t i = 0; i < num_cells * stride; i += lanes) hn::Store(hn::Zero(d), d, jacobian + i);
  for (const EndRow* end = ends; end < ends + num_ends; ++end) {
    const auto x0 = hn::Set(d, end->of_x[0]), x1 = hn::Set(d, end->of_x[1]);
    const auto y0 = hn::Set(d, end->of_y[0]), y1 = hn::Set(d, end->of_y[1]);
    const float* point0 = points.rows + end->points[0] * 2 * stride;
    const float* point1 = points.rows + end->points[1] * 2 * stride;
    float* row = jacobian + end->cell * stride;
    int32_t in_blocks = points.blocks[end->points[0]] | points.blocks[end->points[1]];
    blocks[end->cell] |= in_blocks;
    for (; in_blocks != 0; in_blocks >>= 1, row += kBlock, point0 += kBlock, point1 += kBlock) {
      if ((in_blocks & 1) == 0) continue;
      for (size_t column = 0; column < kBlock; column += lanes) {
        auto sum = hn::Load(d, row + column);
        sum = hn::MulAdd(x0, hn::Load(d, point0 + column), sum);
        sum = hn::MulAdd(y0, hn::Load(d, point0 + stride + column), sum);
        sum = hn::MulAdd(x1, hn::Load(d, point1 + column), sum);
        sum = hn::MulAdd(y1, hn::Load(d, point1 + stride + column), sum);
        hn::Store(sum, d, row + column);
      }
    }
  }
}

// Cells within reach of a cell's blur: where their rows begin, and which weight they have.
struct NearCells {
  static constexpr size_t kMost = static_cast<size_t>((kBlurRadius + 1) * kSide) + 2 * kAtOnce;
  int32_t row[kMost], weight[kMost];
  size_t count = 0;
  int32_t blocks = 0;
};

// Those of cell i and after it. First kAtOnce of a row are listed, without branches: how many a row has is not
// predictable.
HWY_INLINE void list_near(const EndCells& cells, size_t i, int32_t stride, NearCells& near) {
  const hn::CappedTag<int32_t, kAtOnce> d;
  const size_t lanes = hn::Lanes(d);
  const int32_t x = cells.x[i], rows = HWY_MIN(kBlurRadius + 1, cells.y_end - cells.y[i]);
  const auto lane = hn::Iota(d, 0), strides = hn::Set(d, stride);
  auto blocks = hn::Zero(d);
  const int32_t* rank = cells.rank + cells.y[i] * cells.rank_stride + x;
  const int32_t* first_rank = rank + 1;
  size_t count = 0;
  for (int32_t dy = 0; dy < rows; ++dy) {
    const int32_t begin = *first_rank, in_row = rank[kBlurRadius + 1] - begin;
    const auto end = hn::Set(d, begin + in_row), middle = hn::Set(d, dy * kSide + kBlurRadius - x);
    size_t t = 0;
    do {
      for (const size_t next = t + kAtOnce; t < next; t += lanes) {
        const auto j = hn::Add(lane, hn::Set(d, begin + static_cast<int32_t>(t)));
        const size_t from = static_cast<size_t>(begin) + t;
        hn::StoreU(hn::Mul(j, strides), d, near.row + count + t);
        hn::StoreU(hn::Add(hn::LoadU(d, cells.x + from), middle), d, near.weight + count + t);
        blocks = hn::Or(blocks, hn::IfThenElseZero(hn::Lt(j, end), hn::LoadU(d, cells.blocks + from)));
      }
    } while (t < static_cast<size_t>(in_row));
    count += static_cast<size_t>(in_row);
    rank += cells.rank_stride;
    first_rank = rank - kBlurRadius;
  }
  near.count = count;
  HWY_ALIGN int32_t of_lane[kAtOnce] = {};
  hn::Store(blocks, d, of_lane);
  near.blocks = of_lane[0] | of_lane[1] | of_lane[2] | of_lane[3] | cells.blocks[i];
}

// kVectors registers of every row, from column `first` on.
template <size_t kVectors>
void add_near_columns(const EndCells& cells, const float* weights, const float* HWY_RESTRICT jacobian, size_t stride,
                      size_t first, float* HWY_RESTRICT half_near, int32_t* HWY_RESTRICT near_blocks) {
  const Tag d;
  const size_t lanes = hn::Lanes(d);
  NearCells near;
  for (size_t i = 0; i < cells.count; ++i) {
    list_near(cells, i, static_cast<int32_t>(stride), near);
    near_blocks[i] = near.blocks;
    const float* row = jacobian + i * stride + first;
    const auto half = hn::Set(d, 0.5f * weights[kBlurRadius]);
    auto a = hn::Mul(half, hn::Load(d, row)), b = a, c = a;
    if constexpr (kVectors > 1) b = hn::Mul(half, hn::Load(d, row + lanes));
    if constexpr (kVectors > 2) c = hn::Mul(half, hn::Load(d, row + 2 * lanes));
    auto a1 = hn::Zero(d), b1 = a1, c1 = a1;  // two sums each: they need not wait for each other
    near.row[near.count] = near.row[0];
    near.weight[near.count] = kNoWeight;
    for (size_t n = 0; n < near.count; n += 2) {
      const auto k = hn::Set(d, weights[near.weight[n]]), k1 = hn::Set(d, weights[near.weight[n + 1]]);
      row = jacobian + near.row[n] + first;
      const float* const row1 = jacobian + near.row[n + 1] + first;
      a = hn::MulAdd(k, hn::Load(d, row), a);
      a1 = hn::MulAdd(k1, hn::Load(d, row1), a1);
      if constexpr (kVectors > 1) b = hn::MulAdd(k, hn::Load(d, row + lanes), b);
      if constexpr (kVectors > 1) b1 = hn::MulAdd(k1, hn::Load(d, row1 + lanes), b1);
      if constexpr (kVectors > 2) c = hn::MulAdd(k, hn::Load(d, row + 2 * lanes), c);
      if constexpr (kVectors > 2) c1 = hn::MulAdd(k1, hn::Load(d, row1 + 2 * lanes), c1);
    }
    a = hn::Add(a, a1);
    b = hn::Add(b, b1);
    c = hn::Add(c, c1);
    float* const out = half_near + i * stride + first;
    hn::Store(a, d, out);
    if constexpr (kVectors > 1) hn::Store(b, d, out + lanes);
    if constexpr (kVectors > 2) hn::Store(c, d, out + 2 * lanes);
  }
}

void add_near_rows(const EndCells& cells, const float* jacobian, size_t stride, float* half_near,
                   int32_t* near_blocks) {
  float weights[kNoWeight + 1] = {};
  for (int dy = 0; dy <= kBlurRadius; ++dy) {
    for (int dx = -kBlurRadius; dx <= kBlurRadius; ++dx) {
      weights[dy * kSide + dx + kBlurRadius] =
          kBlurKernel[static_cast<size_t>(dy)] * kBlurKernel[static_cast<size_t>(std::abs(dx))];
    }
  }
  const size_t lanes = hn::Lanes(Tag());
  size_t column = 0;
  for (; column + 3 * lanes <= stride; column += 3 * lanes) {
    add_near_columns<3>(cells, weights, jacobian, stride, column, half_near, near_blocks);
  }
  for (; column < stride; column += lanes) {
    add_near_columns<1>(cells, weights, jacobian, stride, column, half_near, near_blocks);
  }
}

void find_bits(const int32_t* HWY_RESTRICT blocks, size_t n, size_t num_blocks, uint64_t* HWY_RESTRICT bits) {
  for (size_t b = 0; b < num_blocks; ++b) {
    for (size_t first = 0; first < n; first += 64) {
      uint64_t word = 0;
      const size_t count = HWY_MIN(n - first, size_t{64});
      for (size_t i = 0; i < count; ++i) word |= static_cast<uint64_t>(blocks[first + i] >> b & 1) << i;
      *bits++ = word;
    }
  }
}

// A few rows of one block of the product, kVectors registers each, kSums registers together. [guess]
constexpr size_t kSums = 8;
template <size_t kVectors>
HWY_INLINE void product_rows(const float* a, const float* b, const uint64_t* a_bits, const uint64_t* b_bits,
                             size_t num_words, size_t stride, float* product) {
  const Tag d;
  const size_t lanes = hn::Lanes(d);
  auto s0 = hn::Zero(d), s1 = s0, s2 = s0, s3 = s0, s4 = s0, s5 = s0, s6 = s0, s7 = s0;
  for (size_t w = 0; w < num_words; ++w) {
    for (uint64_t bits = a_bits[w] & b_bits[w]; bits != 0; bits &= bits - 1) {
      const size_t i = 64 * w + static_cast<size_t>(__builtin_ctzll(bits));
      const float* const of_a = a + i * stride;
      const float* const of_b = b + i * stride;
      const auto b0 = hn::Load(d, of_b);
      auto b1 = b0, b2 = b0, b3 = b0;
      if constexpr (kVectors > 1) b1 = hn::Load(d, of_b + lanes);
      if constexpr (kVectors > 2) b2 = hn::Load(d, of_b + 2 * lanes), b3 = hn::Load(d, of_b + 3 * lanes);
      if constexpr (kVectors == 2) b2 = b0, b3 = b1;
      const auto add = [&](size_t sum, Vector of_column, Vector& to)
                           HWY_ATTR { to = hn::MulAdd(hn::Set(d, of_a[sum / kVectors]), of_column, to); };
      add(0, b0, s0);
      add(1, b1, s1);
      add(2, b2, s2);
      add(3, b3, s3);
      add(4, b0, s4);
      add(5, b1, s5);
      add(6, b2, s6);
      add(7, b3, s7);
    }
  }
  const auto store = [&](size_t sum, Vector value)
                         HWY_ATTR { hn::Store(value, d, product + sum / kVectors * stride + sum % kVectors * lanes); };
  store(0, s0);
  store(1, s1);
  store(2, s2);
  store(3, s3);
  store(4, s4);
  store(5, s5);
  store(6, s6);
  store(7, s7);
}

void transposed_product(const SparseRows& a, const SparseRows& b, size_t n, size_t stride, float* product) {
  constexpr size_t kVectors = HWY_MIN(size_t{4}, kBlock / hn::MaxLanes(Tag()));
  const size_t lanes = hn::Lanes(Tag()), num_words = words_of_bits(n), num_blocks = stride / kBlock;
  for (size_t row = 0; row < stride; row += kSums / kVectors) {
    const uint64_t* const a_bits = a.bits + row / kBlock * num_words;
    for (size_t block = 0; block < num_blocks; ++block) {
      const uint64_t* const b_bits = b.bits + block * num_words;
      for (size_t column = kBlock * block; column < kBlock * (block + 1); column += kVectors * lanes) {
        product_rows<kVectors>(a.rows + row, b.rows + column, a_bits, b_bits, num_words, stride,
                               product + row * stride + column);
      }
    }
  }
}

void weighted_sum(const float* a, const float* weight, size_t n, size_t stride, float* sum) {
  const Tag d;
  for (size_t column = 0; column < stride; column += hn::Lanes(d)) {
    auto even = hn::Zero(d), odd = even;
    size_t i = 0;
    for (; i + 1 < n; i += 2) {
      even = hn::MulAdd(hn::Set(d, weight[i]), hn::Load(d, a + i * stride + column), even);
      odd = hn::MulAdd(hn::Set(d, weight[i + 1]), hn::Load(d, a + (i + 1) * stride + column), odd);
    }
    if (i < n) even = hn::MulAdd(hn::Set(d, weight[i]), hn::Load(d, a + i * stride + column), even);
    hn::Store(hn::Add(even, odd), d, sum + column);
  }
}

}  // namespace silpose::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace silpose {
namespace {

HWY_EXPORT(add_up_ends);
HWY_EXPORT(add_near_rows);
HWY_EXPORT(find_bits);
HWY_EXPORT(transposed_product);
HWY_EXPORT(weighted_sum);

}  // namespace

void add_up_ends(const EndRow* ends, size_t num_ends, const PointRows& points, size_t stride, size_t num_cells,
                 float* jacobian, int32_t* blocks) {
  HWY_DYNAMIC_DISPATCH(add_up_ends)(ends, num_ends, points, stride, num_cells, jacobian, blocks);
}

void add_near_rows(const EndCells& cells, const float* jacobian, size_t stride, float* half_near,
                   int32_t* near_blocks) {
  HWY_DYNAMIC_DISPATCH(add_near_rows)(cells, jacobian, stride, half_near, near_blocks);
}

void find_bits(const int32_t* blocks, size_t n, size_t num_blocks, uint64_t* bits) {
  HWY_DYNAMIC_DISPATCH(find_bits)(blocks, n, num_blocks, bits);
}

void transposed_product(const SparseRows& a, const SparseRows& b, size_t n, size_t stride, float* product) {
  HWY_DYNAMIC_DISPATCH(transposed_product)(a, b, n, stride, product);
}

void weighted_sum(const float* a, const float* weight, size_t n, size_t stride, float* sum) {
  HWY_DYNAMIC_DISPATCH(weighted_sum)(a, weight, n, stride, sum);
}

}  // namespace silpose
#endif  // HWY_ONCE
