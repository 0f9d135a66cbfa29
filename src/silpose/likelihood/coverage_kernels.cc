#include "silpose/likelihood/coverage_kernels.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "silpose/base/aligned_floats.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "silpose/likelihood/coverage_kernels.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

#ifndef SILPOSE_LIKELIHOOD_COVERAGE_KERNELS_ONCE
#define SILPOSE_LIKELIHOOD_COVERAGE_KERNELS_ONCE
namespace silpose {
namespace {

constexpr int32_t kSide = 2 * kBlurRadius + 1;  // cells that a cell's blur reaches along a row
constexpr uint32_t kRowBits = 6;
constexpr size_t kAtOnce = 4;
constexpr size_t kMostNear = static_cast<size_t>((kBlurRadius + 1) * kSide) + kAtOnce;

// Cells after cell i within reach of its blur: number << kRowBits | where the middle of their row is in the weights
// [kBlurRadius + 1, kSide]. First all are listed, without branches but where a row has many: how many a row has is not
// predictable.
size_t list_near(const EndCells& cells, size_t i, uint32_t* near) {
  const int32_t rows = std::min(kBlurRadius + 1, cells.y_end - cells.y[i]);
  size_t count = 0;
  for (int32_t dy = 0; dy < rows; ++dy) {
    const int32_t* const rank = cells.rank + (cells.y[i] + dy) * cells.rank_stride + cells.x[i];
    const auto begin = static_cast<uint32_t>(rank[dy == 0 ? 1 : -kBlurRadius]);
    const uint32_t in_row = static_cast<uint32_t>(rank[kBlurRadius + 1]) - begin;
    const auto of_row = static_cast<uint32_t>(dy * kSide + kBlurRadius);
    for (uint32_t t = 0; t < kAtOnce; ++t) near[count + t] = (begin + t) << kRowBits | of_row;
    for (uint32_t t = kAtOnce; t < in_row; ++t) near[count + t] = (begin + t) << kRowBits | of_row;
    count += in_row;
  }
  return count;
}

}  // namespace
}  // namespace silpose
#endif

HWY_BEFORE_NAMESPACE();
namespace silpose::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::ScalableTag<float>;
using Vector = hn::Vec<Tag>;

CellBox place_ends(const SpanEnds& ends, const CellGrid& grid, const PlacedEnds& placed) {
  const hn::CappedTag<float, kSpanSpare> d;
  const hn::RebindToSigned<decltype(d)> di;
  const auto zero = hn::Zero(d), width = hn::Set(d, grid.picture_width);
  const auto cells_per_pixel = hn::Set(d, grid.cells_per_pixel), row_weight = hn::Set(d, grid.cells_per_row);
  const auto last_x = hn::Set(di, grid.last_x), stride = hn::Set(di, grid.stride);
  const auto rank_stride = hn::Set(di, grid.rank_stride), margin = hn::Set(di, grid.margin);
  auto x0 = last_x, x1 = hn::Zero(di), y0 = hn::Set(di, INT32_MAX), y1 = x1;
  for (size_t i = 0; i < ends.count; i += hn::Lanes(d)) {
    const auto x = hn::LoadU(d, ends.x + i), side = hn::LoadU(d, ends.side + i);
    const auto in_cells = hn::Mul(hn::Min(hn::Max(x, zero), width), cells_per_pixel);
    const auto cell_x = hn::Min(hn::ConvertTo(di, in_cells), last_x);
    // Half a row off, so that rounding does not matter.
    const auto row = hn::Add(hn::ConvertTo(d, hn::LoadU(di, ends.row + i)), hn::Set(d, 0.5f));
    const auto cell_y = hn::ConvertTo(di, hn::Mul(row, row_weight));
    const auto change = hn::Mul(side, row_weight);
    const auto beyond = hn::Mul(change, hn::Sub(in_cells, hn::ConvertTo(d, cell_x)));
    hn::StoreU(hn::Sub(change, beyond), d, placed.here + i);
    hn::StoreU(beyond, d, placed.beyond + i);
    hn::StoreU(hn::Add(hn::Mul(cell_x, stride), hn::Add(cell_y, margin)), di, placed.at + i);
    const auto rank_at = hn::Add(hn::Mul(cell_y, rank_stride), hn::Add(cell_x, margin));
    const auto inside = hn::RebindMask(di, hn::And(hn::Gt(x, zero), hn::Lt(x, width)));
    hn::StoreU(hn::IfThenElse(inside, rank_at, hn::Set(di, -1)), di, placed.rank_at + i);
    const auto counts = hn::FirstN(di, ends.count - i);
    x0 = hn::Min(x0, hn::IfThenElse(counts, cell_x, x0));
    x1 = hn::Max(x1, hn::IfThenElseZero(counts, cell_x));
    y0 = hn::Min(y0, hn::IfThenElse(counts, cell_y, y0));
    y1 = hn::Max(y1, hn::IfThenElseZero(counts, cell_y));
  }
  return {hn::GetLane(hn::MinOfLanes(di, x0)), hn::GetLane(hn::MinOfLanes(di, y0)),
          hn::GetLane(hn::MaxOfLanes(di, x1)) + 1, hn::GetLane(hn::MaxOfLanes(di, y1)) + 1};
}

void subtract_observed(const ObservedCells& cells, float* difference, size_t stride, size_t height, size_t width) {
  const Tag d;
  for (size_t y = 0; y < height; y += hn::Lanes(d)) {
    auto covered = hn::Zero(d);
    for (size_t x = 0; x < width; ++x) {
      float* const cell = difference + x * stride + y;
      covered = hn::Add(covered, hn::LoadU(d, cell));
      auto left = hn::Sub(covered, hn::LoadU(d, cells.observed + x * cells.stride + y));
      if (cells.confidence != nullptr) left = hn::Mul(left, hn::LoadU(d, cells.confidence + x * cells.stride + y));
      hn::StoreU(left, d, cell);
    }
  }
}

double blur_cells(const float* difference, size_t stride, size_t width, size_t height, float* half, float* blurred) {
  const Tag d;
  const size_t lanes = hn::Lanes(d), padded = AlignedFloats::padded(width);
  const auto k0 = hn::Set(d, kBlurKernel[0]), k1 = hn::Set(d, kBlurKernel[1]), k2 = hn::Set(d, kBlurKernel[2]),
             k3 = hn::Set(d, kBlurKernel[3]), k4 = hn::Set(d, kBlurKernel[4]);
  for (size_t y = 0; y < height; ++y) {
    const float* const in = difference + y * stride;
    for (size_t x = 0; x < width; x += lanes) {
      const float* const at = in + x;
      const auto both = [&](size_t distance)
                            HWY_ATTR { return hn::Add(hn::LoadU(d, at - distance), hn::LoadU(d, at + distance)); };
      auto sum = hn::Mul(k0, hn::LoadU(d, at));
      sum = hn::MulAdd(k1, both(1), sum);
      sum = hn::MulAdd(k2, both(2), sum);
      sum = hn::MulAdd(k3, both(3), sum);
      sum = hn::MulAdd(k4, both(4), sum);
      hn::Store(sum, d, half + y * padded + x);
    }
  }
  double total = 0;
  for (size_t y = 0; y < height; ++y) {
    auto of_row = hn::Zero(d);
    for (size_t x = 0; x < width; x += lanes) {
      const float* const at = half + y * padded + x;
      auto sum = hn::Mul(k0, hn::Load(d, at));
      const auto add = [&](size_t distance, Vector k) HWY_ATTR {
        if (y >= distance) sum = hn::MulAdd(k, hn::Load(d, at - distance * padded), sum);
        if (y + distance < height) sum = hn::MulAdd(k, hn::Load(d, at + distance * padded), sum);
      };
      add(1, k1);
      add(2, k2);
      add(3, k3);
      add(4, k4);
      hn::Store(sum, d, blurred + y * padded + x);
      of_row = hn::MulAdd(sum, hn::LoadU(d, difference + y * stride + x), of_row);
    }
    total += static_cast<double>(hn::GetLane(hn::SumOfLanes(d, of_row)));
  }
  return total;
}

void add_up_ends(const EndRow* ends, size_t num_ends, const float* point_rows, size_t stride, size_t num_cells,
                 float* jacobian) {
  const Tag d;
  const size_t lanes = hn::Lanes(d);
  for (size_t i = 0; i < num_cells * stride; i += lanes) hn::Store(hn::Zero(d), d, jacobian + i);
  for (const EndRow* end = ends; end < ends + num_ends; ++end) {
    const auto x0 = hn::Set(d, end->of_x[0]), x1 = hn::Set(d, end->of_x[1]);
    const auto y0 = hn::Set(d, end->of_y[0]), y1 = hn::Set(d, end->of_y[1]);
    const float* const point0 = point_rows + end->points[0] * 2 * stride;
    const float* const point1 = point_rows + end->points[1] * 2 * stride;
    float* const row = jacobian + end->cell * stride;
    for (size_t column = 0; column < stride; column += lanes) {
      auto sum = hn::Load(d, row + column);
      sum = hn::MulAdd(x0, hn::Load(d, point0 + column), sum);
      sum = hn::MulAdd(y0, hn::Load(d, point0 + stride + column), sum);
      sum = hn::MulAdd(x1, hn::Load(d, point1 + column), sum);
      sum = hn::MulAdd(y1, hn::Load(d, point1 + stride + column), sum);
      hn::Store(sum, d, row + column);
    }
  }
}

// kVectors registers of every row, from column `first` on.
template <size_t kVectors>
void add_near_columns(const EndCells& cells, const float* weights, const float* jacobian, size_t stride, size_t first,
                      float* half_near) {
  const Tag d;
  const size_t lanes = hn::Lanes(d);
  uint32_t near[kMostNear];
  for (size_t i = 0; i < cells.count; ++i) {
    const float* row = jacobian + i * stride + first;
    const auto half = hn::Set(d, 0.5f * weights[kBlurRadius]);
    auto a = hn::Mul(half, hn::Load(d, row)), b = a, c = a;
    if constexpr (kVectors > 1) b = hn::Mul(half, hn::Load(d, row + lanes));
    if constexpr (kVectors > 2) c = hn::Mul(half, hn::Load(d, row + 2 * lanes));
    const size_t num_near = list_near(cells, i, near);
    for (size_t n = 0; n < num_near; ++n) {
      const uint32_t j = near[n] >> kRowBits;
      const uint32_t of_row = near[n] & ((1u << kRowBits) - 1);
      const auto k = hn::Set(d, weights[static_cast<int32_t>(of_row) + cells.x[j] - cells.x[i]]);
      row = jacobian + j * stride + first;
      a = hn::MulAdd(k, hn::Load(d, row), a);
      if constexpr (kVectors > 1) b = hn::MulAdd(k, hn::Load(d, row + lanes), b);
      if constexpr (kVectors > 2) c = hn::MulAdd(k, hn::Load(d, row + 2 * lanes), c);
    }
    float* const out = half_near + i * stride + first;
    hn::Store(a, d, out);
    if constexpr (kVectors > 1) hn::Store(b, d, out + lanes);
    if constexpr (kVectors > 2) hn::Store(c, d, out + 2 * lanes);
  }
}

void add_near_rows(const EndCells& cells, const float* jacobian, size_t stride, float* half_near) {
  float weights[(kBlurRadius + 1) * kSide];
  for (int dy = 0; dy <= kBlurRadius; ++dy) {
    for (int dx = -kBlurRadius; dx <= kBlurRadius; ++dx) {
      weights[dy * kSide + dx + kBlurRadius] =
          kBlurKernel[static_cast<size_t>(dy)] * kBlurKernel[static_cast<size_t>(std::abs(dx))];
    }
  }
  const size_t lanes = hn::Lanes(Tag());
  size_t column = 0;
  for (; column + 3 * lanes <= stride; column += 3 * lanes) {
    add_near_columns<3>(cells, weights, jacobian, stride, column, half_near);
  }
  for (; column < stride; column += lanes) add_near_columns<1>(cells, weights, jacobian, stride, column, half_near);
}

// Four rows of the product, kVectors registers of each.
template <size_t kVectors>
void product_block(const float* a, const float* b, size_t n, size_t stride, float* product) {
  const Tag d;
  const size_t lanes = hn::Lanes(d);
  auto p00 = hn::Zero(d), p10 = p00, p20 = p00, p30 = p00;
  auto p01 = p00, p11 = p00, p21 = p00, p31 = p00, p02 = p00, p12 = p00, p22 = p00, p32 = p00;
  for (size_t i = 0; i < n; ++i, a += stride, b += stride) {
    const auto a0 = hn::Set(d, a[0]), a1 = hn::Set(d, a[1]), a2 = hn::Set(d, a[2]), a3 = hn::Set(d, a[3]);
    const auto b0 = hn::Load(d, b);
    p00 = hn::MulAdd(a0, b0, p00);
    p10 = hn::MulAdd(a1, b0, p10);
    p20 = hn::MulAdd(a2, b0, p20);
    p30 = hn::MulAdd(a3, b0, p30);
    if constexpr (kVectors > 1) {
      const auto b1 = hn::Load(d, b + lanes);
      p01 = hn::MulAdd(a0, b1, p01);
      p11 = hn::MulAdd(a1, b1, p11);
      p21 = hn::MulAdd(a2, b1, p21);
      p31 = hn::MulAdd(a3, b1, p31);
    }
    if constexpr (kVectors > 2) {
      const auto b2 = hn::Load(d, b + 2 * lanes);
      p02 = hn::MulAdd(a0, b2, p02);
      p12 = hn::MulAdd(a1, b2, p12);
      p22 = hn::MulAdd(a2, b2, p22);
      p32 = hn::MulAdd(a3, b2, p32);
    }
  }
  const auto store = [&](float* out, Vector v0, Vector v1, Vector v2) HWY_ATTR {
    hn::Store(v0, d, out);
    if constexpr (kVectors > 1) hn::Store(v1, d, out + lanes);
    if constexpr (kVectors > 2) hn::Store(v2, d, out + 2 * lanes);
  };
  store(product, p00, p01, p02);
  store(product + stride, p10, p11, p12);
  store(product + 2 * stride, p20, p21, p22);
  store(product + 3 * stride, p30, p31, p32);
}

void transposed_product(const float* a, const float* b, size_t n, size_t stride, size_t num_columns, float* product) {
  const size_t lanes = hn::Lanes(Tag());
  for (size_t row = 0; row < num_columns; row += 4) {
    float* const out = product + row * stride;
    size_t column = 0;
    for (; column + 3 * lanes <= stride; column += 3 * lanes) {
      product_block<3>(a + row, b + column, n, stride, out + column);
    }
    for (; column < stride; column += lanes) product_block<1>(a + row, b + column, n, stride, out + column);
  }
}

}  // namespace silpose::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace silpose {
namespace {

std::array<float, kBlurRadius + 1> make_kernel() {
  std::array<double, kBlurRadius + 1> weight{};
  double sum = 0;
  for (size_t d = 0; d < weight.size(); ++d) {
    weight[d] = std::exp(-static_cast<double>(d * d) / 4);
    sum += d == 0 ? weight[d] : 2 * weight[d];
  }
  std::array<float, kBlurRadius + 1> kernel{};
  for (size_t d = 0; d < weight.size(); ++d) kernel[d] = static_cast<float>(weight[d] / sum);
  return kernel;
}

}  // namespace

const std::array<float, kBlurRadius + 1> kBlurKernel = make_kernel();

HWY_EXPORT(place_ends);
HWY_EXPORT(subtract_observed);
HWY_EXPORT(blur_cells);
HWY_EXPORT(add_up_ends);
HWY_EXPORT(add_near_rows);
HWY_EXPORT(transposed_product);

CellBox place_ends(const SpanEnds& ends, const CellGrid& grid, const PlacedEnds& placed) {
  return HWY_DYNAMIC_DISPATCH(place_ends)(ends, grid, placed);
}

void subtract_observed(const ObservedCells& cells, float* difference, size_t stride, size_t height, size_t width) {
  HWY_DYNAMIC_DISPATCH(subtract_observed)(cells, difference, stride, height, width);
}

double blur_cells(const float* difference, size_t stride, size_t width, size_t height, float* half, float* blurred) {
  return HWY_DYNAMIC_DISPATCH(blur_cells)(difference, stride, width, height, half, blurred);
}

void add_up_ends(const EndRow* ends, size_t num_ends, const float* point_rows, size_t stride, size_t num_cells,
                 float* jacobian) {
  HWY_DYNAMIC_DISPATCH(add_up_ends)(ends, num_ends, point_rows, stride, num_cells, jacobian);
}

void add_near_rows(const EndCells& cells, const float* jacobian, size_t stride, float* half_near) {
  HWY_DYNAMIC_DISPATCH(add_near_rows)(cells, jacobian, stride, half_near);
}

void transposed_product(const float* a, const float* b, size_t n, size_t stride, size_t num_columns, float* product) {
  HWY_DYNAMIC_DISPATCH(transposed_product)(a, b, n, stride, num_columns, product);
}

}  // namespace silpose
#endif  // HWY_ONCE
