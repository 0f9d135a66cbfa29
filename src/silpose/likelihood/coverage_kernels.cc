#include "silpose/likelihood/coverage_kernels.h"

#include <cmath>

#include "silpose/base/aligned_floats.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "silpose/likelihood/coverage_kernels.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace silpose::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::ScalableTag<float>;
using Vector = hn::Vec<Tag>;

CellBox place_ends(const SpanEnds& ends, const CellGrid& grid, const PlacedEnds& placed) {
  const hn::CappedTag<float, kSpanSpare> d;
  const hn::RebindToSigned<decltype(d)> di;
  const auto zero = hn::Zero(d), width = hn::Set(d, grid.image_width);
  const auto cells_per_pixel = hn::Set(d, grid.cells_per_pixel), row_weight = hn::Set(d, grid.cells_per_row);
  const auto last_x = hn::Set(di, grid.last_x), stride = hn::Set(di, grid.stride);
  const auto margin = hn::Set(di, grid.margin), outside = hn::Set(di, -1);
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
    const auto inside = hn::RebindMask(di, hn::And(hn::Gt(x, zero), hn::Lt(x, width)));
    hn::StoreU(hn::IfThenElse(inside, cell_x, outside), di, placed.x + i);
    hn::StoreU(cell_y, di, placed.y + i);
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

void number_row(const uint64_t* bits, const CellBox& box, int y, int margin, int32_t* HWY_RESTRICT rank,
                const NumberedCells& cells) {
  const hn::CappedTag<int32_t, AlignedFloats::kLanes> d;
  auto count = static_cast<int32_t>(*cells.count);
  const auto from = [&](int x) HWY_ATTR {
    const auto before = hn::Set(d, count);
    for (; x < box.x1 + margin; x += static_cast<int>(hn::Lanes(d))) hn::StoreU(before, d, rank + x);
  };
  from(box.x0 - margin);
  for (int word = box.x0 / 64; word <= (box.x1 - 1) / 64; ++word) {
    for (uint64_t left = bits[word]; left != 0; left &= left - 1) {
      const int x = 64 * word + __builtin_ctzll(left);
      cells.x[count] = x;
      cells.y[count++] = y;
      from(x + 1);
    }
  }
  *cells.count = static_cast<size_t>(count);
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
HWY_EXPORT(number_row);

CellBox place_ends(const SpanEnds& ends, const CellGrid& grid, const PlacedEnds& placed) {
  return HWY_DYNAMIC_DISPATCH(place_ends)(ends, grid, placed);
}

void subtract_observed(const ObservedCells& cells, float* difference, size_t stride, size_t height, size_t width) {
  HWY_DYNAMIC_DISPATCH(subtract_observed)(cells, difference, stride, height, width);
}

double blur_cells(const float* difference, size_t stride, size_t width, size_t height, float* half, float* blurred) {
  return HWY_DYNAMIC_DISPATCH(blur_cells)(difference, stride, width, height, half, blurred);
}

void number_row(const uint64_t* bits, const CellBox& box, int y, int margin, int32_t* rank,
                const NumberedCells& cells) {
  HWY_DYNAMIC_DISPATCH(number_row)(bits, box, y, margin, rank, cells);
}

}  // namespace silpose
#endif  // HWY_ONCE
