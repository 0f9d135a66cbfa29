#include "silpose/render/outline_scan.h"

#include <algorithm>
#include <bit>
#include <new>

#include "silpose/base/check.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "silpose/render/outline_scan.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#ifndef SILPOSE_RENDER_OUTLINE_SCAN_TYPES
#define SILPOSE_RENDER_OUTLINE_SCAN_TYPES
namespace silpose {
namespace {

constexpr int kWordBits = 64;

// A raster's changes of the winding number [words, height + 1, 64], and what part of it they touch.
struct ChangeRaster {
  int8_t* changes;
  int width, height;
  int row_begin, row_end, column_begin, column_end;
};

// Edges that have columns left to cross, as structure of arrays with room for one vector more.
struct ActiveEdges {
  int32_t *column, *column_end;
  int32_t* right_of_left;  // from the left end to the middle of the column, grid
  int32_t* left_y;
  int32_t *dx, *dy;  // from the left end to the right one; dx > 0
  int32_t* change;
};

}  // namespace
}  // namespace silpose
#endif

HWY_BEFORE_NAMESPACE();
namespace silpose {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Of `count` edges keeps those that cross the middle of a column inside the raster. Returns how many.
size_t find_crossing_edges(const GridPoint* HWY_RESTRICT from, const GridPoint* HWY_RESTRICT to, size_t count,
                           int change, ChangeRaster& raster, const ActiveEdges& active) {
  const hn::ScalableTag<int32_t> d;
  const size_t lanes = hn::Lanes(d);
  const auto to_centre = hn::Set(d, kGridPerPixel - 1 - kGridHalfPixel);
  const auto zero = hn::Zero(d), width = hn::Set(d, raster.width);
  const auto half = hn::Set(d, kGridHalfPixel), minus = hn::Set(d, -change), plus = hn::Set(d, change);
  auto first_column = width, last_column = zero;
  size_t kept = 0;
  for (size_t i = 0; i < count; i += lanes) {
    hn::Vec<decltype(d)> ax, ay, bx, by;
    hn::LoadInterleaved2(d, &from[i].x, ax, ay);
    hn::LoadInterleaved2(d, &to[i].x, bx, by);
    const auto turned = hn::Lt(bx, ax);
    const auto left = hn::Min(ax, bx), right = hn::Max(ax, bx);
    const auto left_y = hn::IfThenElse(turned, by, ay), right_y = hn::IfThenElse(turned, ay, by);
    const auto begin = hn::Max(hn::ShiftRight<kGridBits>(hn::Add(left, to_centre)), zero);
    const auto end = hn::Min(hn::ShiftRight<kGridBits>(hn::Add(right, to_centre)), width);
    const auto crosses = hn::And(hn::Lt(begin, end), hn::FirstN(d, count - i));
    first_column = hn::IfThenElse(crosses, hn::Min(first_column, begin), first_column);
    last_column = hn::IfThenElse(crosses, hn::Max(last_column, end), last_column);
    const auto middle = hn::Add(hn::ShiftLeft<kGridBits>(begin), half);
    hn::StoreU(hn::Compress(begin, crosses), d, active.column + kept);
    hn::StoreU(hn::Compress(end, crosses), d, active.column_end + kept);
    hn::StoreU(hn::Compress(hn::Sub(middle, left), crosses), d, active.right_of_left + kept);
    hn::StoreU(hn::Compress(left_y, crosses), d, active.left_y + kept);
    hn::StoreU(hn::Compress(hn::Sub(right, left), crosses), d, active.dx + kept);
    hn::StoreU(hn::Compress(hn::Sub(right_y, left_y), crosses), d, active.dy + kept);
    hn::StoreU(hn::Compress(hn::IfThenElse(turned, minus, plus), crosses), d, active.change + kept);
    kept += hn::CountTrue(d, crosses);
  }
  raster.column_begin = HWY_MIN(raster.column_begin, hn::GetLane(hn::MinOfLanes(d, first_column)));
  raster.column_end = HWY_MAX(raster.column_end, hn::GetLane(hn::MaxOfLanes(d, last_column)));
  return kept;
}

// Adds the changes of all edges at every column they cross; `active` is used up.
void add_crossings(const ActiveEdges& active, size_t count, ChangeRaster& raster) {
  const hn::ScalableTag<double> f64;
  const hn::Rebind<int32_t, decltype(f64)> d;
  const size_t lanes = hn::Lanes(d);
  const auto to_centre = hn::Set(d, kGridPerPixel - 1 - kGridHalfPixel);
  const auto zero = hn::Zero(d), height = hn::Set(d, raster.height), one = hn::Set(d, 1);
  const auto word_stride = hn::Set(d, (raster.height + 1) * kWordBits);
  const auto in_word = hn::Set(d, kWordBits - 1), pixel = hn::Set(d, kGridPerPixel);
  auto first_row = height, last_row = zero;
  HWY_ALIGN int32_t cells[hn::MaxLanes(hn::ScalableTag<int32_t>())], changes[hn::MaxLanes(hn::ScalableTag<int32_t>())];
  while (count > 0) {
    size_t kept = 0;
    for (size_t i = 0; i < count; i += lanes) {
      const size_t valid = HWY_MIN(lanes, count - i);
      const auto column = hn::LoadU(d, active.column + i), end = hn::LoadU(d, active.column_end + i);
      const auto across = hn::LoadU(d, active.right_of_left + i), left_y = hn::LoadU(d, active.left_y + i);
      const auto dx = hn::LoadU(d, active.dx + i), dy = hn::LoadU(d, active.dy + i);
      const auto change = hn::LoadU(d, active.change + i);
      // The product is below 2^53, and a quotient of these is further from any integer than the division's rounding:
      // floor and ceiling are exact. Where the edge falls, its own points lie on its upper side, else on its lower.
      const auto fall = hn::PromoteTo(f64, dy);
      const auto exact = hn::Div(hn::Mul(fall, hn::PromoteTo(f64, across)), hn::PromoteTo(f64, dx));
      const auto whole = hn::Floor(exact);
      const auto next = hn::Or(hn::Gt(fall, hn::Zero(f64)), hn::Lt(whole, exact));
      const auto below = hn::DemoteTo(d, hn::Add(whole, hn::IfThenElseZero(next, hn::Set(f64, 1.0))));
      const auto row_centre = hn::ShiftRight<kGridBits>(hn::Add(hn::Add(left_y, below), to_centre));
      const auto row = hn::Min(hn::Max(row_centre, zero), height);
      const auto counts = hn::FirstN(d, valid);
      first_row = hn::IfThenElse(counts, hn::Min(first_row, row), first_row);
      last_row = hn::IfThenElse(counts, hn::Max(last_row, row), last_row);
      const auto word = hn::Mul(hn::ShiftRight<6>(column), word_stride);
      hn::Store(hn::Add(hn::Add(word, hn::ShiftLeft<6>(row)), hn::And(column, in_word)), d, cells);
      hn::Store(change, d, changes);
      for (size_t k = 0; k < valid; ++k) {
        raster.changes[cells[k]] = static_cast<int8_t>(raster.changes[cells[k]] + changes[k]);
      }
      const auto next_column = hn::Add(column, one);
      const auto goes_on = hn::And(hn::Lt(next_column, end), counts);
      hn::StoreU(hn::Compress(next_column, goes_on), d, active.column + kept);
      hn::StoreU(hn::Compress(end, goes_on), d, active.column_end + kept);
      hn::StoreU(hn::Compress(hn::Add(across, pixel), goes_on), d, active.right_of_left + kept);
      hn::StoreU(hn::Compress(left_y, goes_on), d, active.left_y + kept);
      hn::StoreU(hn::Compress(dx, goes_on), d, active.dx + kept);
      hn::StoreU(hn::Compress(dy, goes_on), d, active.dy + kept);
      hn::StoreU(hn::Compress(change, goes_on), d, active.change + kept);
      kept += hn::CountTrue(d, goes_on);
    }
    count = kept;
  }
  raster.row_begin = HWY_MIN(raster.row_begin, hn::GetLane(hn::MinOfLanes(d, first_row)));
  raster.row_end = HWY_MAX(raster.row_end, HWY_MIN(hn::GetLane(hn::MaxOfLanes(d, last_row)) + 1, raster.height));
}

// Sums the changes of 64 columns downwards, and puts them back to zero: bits [rows] of where the sum is not zero.
void sum_columns(int8_t* HWY_RESTRICT changes, size_t num_rows, uint64_t* HWY_RESTRICT inside) {
#if HWY_TARGET == HWY_SCALAR
  int8_t winding[kWordBits] = {};
  for (size_t y = 0; y < num_rows; ++y, changes += kWordBits) {
    uint64_t bits = 0;
    for (size_t x = 0; x < kWordBits; ++x) {
      winding[x] = static_cast<int8_t>(winding[x] + changes[x]);
      changes[x] = 0;
      bits |= static_cast<uint64_t>(winding[x] != 0) << x;
    }
    inside[y] = bits;
  }
#else
  const hn::CappedTag<int8_t, kWordBits> d;
  constexpr size_t kLanes = hn::MaxLanes(hn::CappedTag<int8_t, kWordBits>());
  const auto zero = hn::Zero(d);
  auto* const bytes = reinterpret_cast<uint8_t*>(inside);
  for (size_t x = 0; x < kWordBits; x += kLanes) {
    auto winding = zero;
    for (size_t y = 0; y < num_rows; ++y) {
      winding = hn::Add(winding, hn::LoadU(d, changes + y * kWordBits + x));
      hn::StoreU(zero, d, changes + y * kWordBits + x);
      uint8_t mask[8];
      hn::StoreMaskBits(d, hn::Ne(winding, zero), mask);
      hwy::CopyBytes<kLanes / 8>(mask, bytes + y * sizeof(uint64_t) + x / 8);
    }
  }
#endif
}

void count_bits(const OutlineScan::Bits& part, const uint64_t* HWY_RESTRICT observed, size_t words_per_row,
                int64_t* model, int64_t* both) {
  size_t all = 0, common = 0;
  for (int w = part.word_begin; w < part.word_end; ++w) {
    const uint64_t* const column = part.words + static_cast<size_t>(w) * static_cast<size_t>(part.height);
    for (auto y = static_cast<size_t>(part.row_begin); y < static_cast<size_t>(part.row_end); ++y) {
      const uint64_t word = column[y];
      all += hwy::PopCount(word);
      common += hwy::PopCount(word & observed[y * words_per_row + static_cast<size_t>(w)]);
    }
  }
  *model = static_cast<int64_t>(all);
  *both = static_cast<int64_t>(common);
}

}  // namespace HWY_NAMESPACE
}  // namespace silpose
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace silpose {
namespace {

HWY_EXPORT(find_crossing_edges);
HWY_EXPORT(add_crossings);
HWY_EXPORT(sum_columns);
HWY_EXPORT(count_bits);

constexpr size_t kSpareLanes = 16;  // the widest vector's: whole vectors are written where fewer count

void add_edges(const OutlineEdges::Edges& edges, int change, std::vector<int32_t>& scratch, ChangeRaster& raster) {
  if (edges.count == 0) return;
  const size_t stride = edges.count + kSpareLanes;
  if (scratch.size() < 7 * stride) scratch.resize(7 * stride);
  int32_t* const first = scratch.data();
  const ActiveEdges active{first,
                           first + stride,
                           first + 2 * stride,
                           first + 3 * stride,
                           first + 4 * stride,
                           first + 5 * stride,
                           first + 6 * stride};
  const size_t count = HWY_DYNAMIC_DISPATCH(find_crossing_edges)(edges.from.data(), edges.to.data(), edges.count,
                                                                 change, raster, active);
  HWY_DYNAMIC_DISPATCH(add_crossings)(active, count, raster);
}

}  // namespace

void OutlineScan::resize(int width, int height) {
  if (width == width_ && height == height_) return;
  check(width >= 0 && height >= 0 && int64_t{width} * height < (int64_t{1} << 30), "OutlineScan: a raster of {}x{}",
        width, height);
  const auto words = static_cast<size_t>((width + kWordBits - 1) / kWordBits);
  const size_t num_changes = std::max<size_t>(1, words * static_cast<size_t>(height + 1) * kWordBits);
  changes_.reset(static_cast<int8_t*>(std::calloc(num_changes, 1)));
  if (!changes_) throw std::bad_alloc();
  inside_ = std::make_unique_for_overwrite<uint64_t[]>(words * static_cast<size_t>(height));
  width_ = width;
  height_ = height;
}

void OutlineScan::scan(std::span<const GridPoint> points, bool some_unseen, int width, int height,
                       std::span<const Face> cut_faces) {
  resize(width, height);
  edges_.find(points, some_unseen, cut_faces);
  ChangeRaster raster{.changes = changes_.get(),
                      .width = width,
                      .height = height,
                      .row_begin = height,
                      .row_end = 0,
                      .column_begin = width,
                      .column_end = 0};
  add_edges(edges_.between_faces(), 2, active_, raster);
  add_edges(edges_.of_one_face(), 1, active_, raster);
  row_begin_ = raster.row_begin;
  row_end_ = std::max(raster.row_begin, raster.row_end);
  word_begin_ = raster.column_begin / kWordBits;
  word_end_ = std::max(word_begin_, (raster.column_end + kWordBits - 1) / kWordBits);
  for (int w = word_begin_; w < word_end_; ++w) {
    const auto first_row = static_cast<size_t>(w) * static_cast<size_t>(height + 1) + static_cast<size_t>(row_begin_);
    HWY_DYNAMIC_DISPATCH(sum_columns)
    (changes_.get() + first_row * kWordBits, static_cast<size_t>(row_end_ - row_begin_),
     inside_.get() + static_cast<size_t>(w) * static_cast<size_t>(height) + static_cast<size_t>(row_begin_));
  }
}

void OutlineScan::draw(Mask& mask) const {
  for (int w = word_begin_; w < word_end_; ++w) {
    const uint64_t* const column = inside_.get() + static_cast<size_t>(w) * static_cast<size_t>(height_);
    for (int y = row_begin_; y < row_end_; ++y) mask.row(y)[static_cast<size_t>(w)] = column[y];
  }
}

OutlineRenderer::Counts OutlineScan::count(const Mask& observed) const {
  OutlineRenderer::Counts counts;
  HWY_DYNAMIC_DISPATCH(count_bits)
  (bits(), observed.words().data(), static_cast<size_t>(observed.words_per_row()), &counts.model, &counts.both);
  return counts;
}

std::optional<PixelBounds> OutlineScan::bounds() const {
  int x0 = width_, x1 = 0, y0 = height_, y1 = 0;
  for (int w = word_begin_; w < word_end_; ++w) {
    const uint64_t* const column = inside_.get() + static_cast<size_t>(w) * static_cast<size_t>(height_);
    uint64_t any = 0;
    for (int y = row_begin_; y < row_end_; ++y) {
      if (column[y] == 0) continue;
      any |= column[y];
      y0 = std::min(y0, y);
      y1 = std::max(y1, y + 1);
    }
    if (any == 0) continue;
    x0 = std::min(x0, kWordBits * w + std::countr_zero(any));
    x1 = std::max(x1, kWordBits * (w + 1) - std::countl_zero(any));
  }
  if (y1 == 0) return std::nullopt;
  return PixelBounds{.x0 = double(x0), .y0 = double(y0), .x1 = double(x1), .y1 = double(y1)};
}

}  // namespace silpose
#endif  // HWY_ONCE
