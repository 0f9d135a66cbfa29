#include "silpose/render/span_kernels.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "silpose/render/span_kernels.cc"
#include <hwy/foreach_target.h>
// After foreach_target.h.
#include <hwy/highway.h>

// After highway.h.
#include "silpose/render/strip_edges-inl.h"

HWY_BEFORE_NAMESPACE();
namespace silpose::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Positions [0, kBlock) of a block whose points lie in strip order.
HWY_INLINE void find_winding_of_block(const float* HWY_RESTRICT xy, size_t num_positions,
                                      uint8_t* HWY_RESTRICT winding) {
#if HWY_TARGET == HWY_SCALAR
  for (size_t p = 0; p < num_positions; p += 8) {
    uint32_t bits = 0;
    for (size_t i = 0; i < 8; ++i) {
      const float* const a = xy + 2 * (p + i);
      bits |= static_cast<uint32_t>((a[2] - a[0]) * (a[5] - a[1]) < (a[3] - a[1]) * (a[4] - a[0])) << i;
    }
    winding[p / 8] = static_cast<uint8_t>(bits);
  }
#else
  const hn::CappedTag<float, 16> d;
  const hn::Repartition<int64_t, decltype(d)> d64;
  constexpr size_t kPositions = hn::MaxLanes(hn::CappedTag<float, 16>()) / 2;
  for (size_t p = 0; p < num_positions; p += 8) {
    uint32_t bits = 0;
    for (size_t i = 0; i < 8; i += kPositions) {
      const float* const at = xy + 2 * (p + i);
      const auto a = hn::LoadU(d, at);
      const auto ab = hn::Sub(hn::LoadU(d, at + 2), a), ac = hn::Sub(hn::LoadU(d, at + 4), a);
      const auto products = hn::Mul(ab, hn::Shuffle2301(ac));  // ab.x ac.y, ab.y ac.x
      const auto is_less = hn::VecFromMask(d, hn::Lt(hn::Shuffle2301(products), products));
      uint8_t mask[8];
      hn::StoreMaskBits(d64, hn::MaskFromVec(hn::BitCast(d64, hn::DupOdd(is_less))), mask);
      bits |= static_cast<uint32_t>(mask[0]) << i;
    }
    winding[p / 8] = static_cast<uint8_t>(bits);
  }
#endif
}

void find_winding(const float* HWY_RESTRICT pixels, const uint32_t* HWY_RESTRICT vertex, size_t num_positions,
                  uint8_t* HWY_RESTRICT winding) {
  constexpr size_t kBlock = 512, kAhead = 16;  // a vector of triangles needs two vertices beyond it
  static_assert(kAhead <= StripOrder::kPadding);
  HWY_ALIGN float xy[2 * (kBlock + kAhead)];
  for (size_t begin = 0; begin < num_positions; begin += kBlock) {
    const size_t count = HWY_MIN(kBlock, num_positions - begin);
    for (size_t i = 0; i < count + kAhead; ++i) {
      hwy::CopyBytes<2 * sizeof(float)>(pixels + 2 * size_t{vertex[begin + i]}, xy + 2 * i);
    }
    find_winding_of_block(xy, count, winding + begin / 8);
  }
}

size_t find_inner_outline(const StripView& strips, const uint32_t* HWY_RESTRICT vertex,
                          const uint8_t* HWY_RESTRICT winding, uint64_t* HWY_RESTRICT found,
                          const OutlineList& outline) {
  uint32_t* const HWY_RESTRICT out_from = outline.from;
  uint32_t* const HWY_RESTRICT out_to = outline.to;
  return find_strip_edges(strips, winding, found, [&](size_t i, size_t begin, size_t end) HWY_ATTR {
    out_from[i] = vertex[begin];
    out_to[i] = vertex[end];
  });
}

size_t find_row_edges(const OutlineList& outline, size_t count, const float* HWY_RESTRICT pixels,
                      const SampledRows& rows, const RowEdges& edges) {
  const hn::CappedTag<float, kSpanSpare> d;
  const hn::RebindToSigned<decltype(d)> di;
  const auto first = hn::Set(d, rows.first), rows_per_pixel = hn::Set(d, 1 / rows.step);
  const auto row_count = hn::Set(d, static_cast<float>(rows.count)), one = hn::Set(d, 1.0f);
  const auto row_from = [&](hn::VFromD<decltype(d)> y) HWY_ATTR {
    const auto row = hn::Mul(hn::Sub(y, first), rows_per_pixel);
    return hn::ConvertTo(di, hn::Ceil(hn::Min(hn::Max(row, hn::Zero(d)), row_count)));
  };
  size_t num_kept = 0;
  for (size_t i = 0; i < count; i += hn::Lanes(d)) {
    const auto from = hn::BitCast(di, hn::LoadU(hn::RebindToUnsigned<decltype(d)>(), outline.from + i));
    const auto to = hn::BitCast(di, hn::LoadU(hn::RebindToUnsigned<decltype(d)>(), outline.to + i));
    const auto at_from = hn::ShiftLeft<1>(from), at_to = hn::ShiftLeft<1>(to);
    const auto from_x = hn::GatherIndex(d, pixels, at_from), from_y = hn::GatherIndex(d, pixels + 1, at_from);
    const auto to_x = hn::GatherIndex(d, pixels, at_to), to_y = hn::GatherIndex(d, pixels + 1, at_to);
    const auto upwards = hn::Lt(to_y, from_y);
    const auto upwards_int = hn::RebindMask(di, upwards);
    const auto top_x = hn::IfThenElse(upwards, to_x, from_x), top_y = hn::IfThenElse(upwards, to_y, from_y);
    const auto bottom_x = hn::IfThenElse(upwards, from_x, to_x), bottom_y = hn::IfThenElse(upwards, from_y, to_y);
    // Rows with top <= y < bottom: decided by each vertex alone, so that every row's changes add up to none.
    const auto row_begin = row_from(top_y), row_end = row_from(bottom_y);
    const auto inverse_height = hn::Div(one, hn::Sub(bottom_y, top_y));
    const auto change = hn::LoadU(di, outline.change + i);
    const auto kept_int = hn::And(hn::Lt(row_begin, row_end), hn::FirstN(di, count - i));
    const auto kept = hn::RebindMask(d, kept_int);
    const auto put_int = [&](hn::VFromD<decltype(di)> value, int32_t* to_array)
                             HWY_ATTR { hn::StoreU(hn::Compress(value, kept_int), di, to_array + num_kept); };
    const auto put = [&](hn::VFromD<decltype(d)> value, float* to_array)
                         HWY_ATTR { hn::StoreU(hn::Compress(value, kept), d, to_array + num_kept); };
    put_int(hn::IfThenElse(upwards_int, to, from), edges.vertex_a);
    put_int(hn::IfThenElse(upwards_int, from, to), edges.vertex_b);
    put_int(hn::IfThenElse(upwards_int, hn::Neg(change), change), edges.change);
    put_int(row_begin, edges.row_begin);
    put_int(row_end, edges.row_end);
    put(top_x, edges.top_x);
    put(top_y, edges.top_y);
    put(hn::Mul(hn::Sub(bottom_x, top_x), inverse_height), edges.dx_dy);
    put(inverse_height, edges.inverse_height);
    num_kept += hn::CountTrue(di, kept_int);
  }
  return num_kept;
}

// The bits of floats to integers of the same order, and back.
template <class D, class V>
HWY_INLINE V exchange_order(D di, V bits) {
  return hn::Xor(bits, hn::And(hn::ShiftRight<31>(bits), hn::Set(di, 0x7fffffff)));
}

size_t cross_rows(const RowEdges& edges, size_t count, const SampledRows& rows, Crossing* HWY_RESTRICT crossings,
                  int32_t* HWY_RESTRICT row) {
  const hn::CappedTag<float, 8> d;  // few edges cross more rows
  const hn::RebindToSigned<decltype(d)> di;
  const auto first = hn::Set(d, rows.first), step = hn::Set(d, rows.step);
  const auto lanes = hn::Iota(di, 0);
  size_t total = 0;
  for (size_t e = 0; e < count; ++e) {
    const auto top_x = hn::Set(d, edges.top_x[e]), top_y = hn::Set(d, edges.top_y[e]);
    const auto dx_dy = hn::Set(d, edges.dx_dy[e]);
    const auto low = hn::Set(di, static_cast<int32_t>(e) << 4 | (edges.change[e] + 2));
    const int32_t begin = edges.row_begin[e];
    const auto num_rows = static_cast<size_t>(edges.row_end[e] - begin);
    size_t i = 0;
    do {
      const auto at_row = hn::Add(lanes, hn::Set(di, begin + static_cast<int32_t>(i)));
      const auto y_below = hn::Sub(hn::MulAdd(hn::ConvertTo(d, at_row), step, first), top_y);
      const auto x = hn::MulAdd(dx_dy, y_below, top_x);
      hn::StoreInterleaved2(low, exchange_order(di, hn::BitCast(di, x)), di,
                            reinterpret_cast<int32_t*>(crossings + total + i));
      hn::StoreU(at_row, di, row + total + i);
      i += hn::Lanes(d);
    } while (i < num_rows);
    total += num_rows;
  }
  return total;
}

// Sorting by insertion: the same steps for every row, whatever its numbers are. Rows lie side by side.
HWY_INLINE void sort_rows(Crossing* begin, const Crossing* end) {
  const hn::CappedTag<Crossing, kGroupRows> d;
  for (Crossing* next = begin + kGroupRows; next < end; next += kGroupRows) {
    auto inserted = hn::Load(d, next);
    for (Crossing* at = begin; at < next; at += kGroupRows) {
      const auto sorted = hn::Load(d, at);
      hn::Store(hn::Min(sorted, inserted), d, at);
      inserted = hn::Max(sorted, inserted);
    }
    hn::Store(inserted, d, next);
  }
}

size_t find_span_ends(const RowGroup* HWY_RESTRICT groups, size_t num_groups, GroupCrossings* HWY_RESTRICT crossings,
                      const EndLists& ends) {
  const hn::CappedTag<Crossing, kGroupRows> d;
  const hn::RebindToUnsigned<decltype(d)> du;
  const hn::Rebind<uint32_t, decltype(d)> du32;
  const hn::Rebind<int32_t, decltype(d)> d32;
  const hn::Rebind<float, decltype(d)> df;
  constexpr size_t kLanes = hn::MaxLanes(hn::CappedTag<Crossing, kGroupRows>());
  const auto zero = hn::Zero(d32), two = hn::Set(d32, 2), low_bits = hn::Set(d32, 15), lanes = hn::Iota(d32, 0);
  const auto left = hn::Set(df, 1.0f), right = hn::Set(df, -1.0f);
  size_t num_ends = 0;
  for (size_t g = 0; g < num_groups; ++g) {
    if (groups[g].count == 0) continue;  // `first` may be past the end, and there may be no crossings at all
    for (size_t lane = 0; lane < kGroupRows; lane += kLanes) {
      Crossing* const begin = crossings[groups[g].first].of_row + lane;
      const Crossing* const end = begin + kGroupRows * groups[g].count;
      sort_rows(begin, end);
      const auto row = hn::Add(lanes, hn::Set(d32, static_cast<int32_t>(kGroupRows * g + lane)));
      auto winding = zero;
      for (const Crossing* at = begin; at < end; at += kGroupRows) {
        const auto crossing = hn::BitCast(du, hn::Load(d, at));
        const auto low = hn::BitCast(d32, hn::TruncateTo(du32, crossing));
        const auto high = hn::BitCast(d32, hn::TruncateTo(du32, hn::ShiftRight<32>(crossing)));
        const auto after = hn::Add(winding, hn::Sub(hn::And(low, low_bits), two));
        const auto begins = hn::Eq(winding, zero);
        const auto is_end = hn::Xor(begins, hn::Eq(after, zero));
        const auto is_end_float = hn::RebindMask(df, is_end);
        const auto x = hn::BitCast(df, exchange_order(d32, high));
        const auto side = hn::IfThenElse(hn::RebindMask(df, begins), left, right);
        hn::StoreU(hn::Compress(x, is_end_float), df, ends.x + num_ends);
        hn::StoreU(hn::Compress(side, is_end_float), df, ends.side + num_ends);
        hn::StoreU(hn::Compress(row, is_end), d32, ends.row + num_ends);
        hn::StoreU(hn::Compress(hn::ShiftRight<4>(low), is_end), d32, ends.edge + num_ends);
        num_ends += hn::CountTrue(d32, is_end);
        winding = after;
      }
    }
  }
  return num_ends;
}

}  // namespace silpose::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace silpose {
namespace {

HWY_EXPORT(find_winding);
HWY_EXPORT(find_inner_outline);
HWY_EXPORT(find_row_edges);
HWY_EXPORT(cross_rows);
HWY_EXPORT(find_span_ends);

}  // namespace

void find_winding(const float* pixels, const uint32_t* vertex, size_t num_positions, uint8_t* winding) {
  HWY_DYNAMIC_DISPATCH(find_winding)(pixels, vertex, num_positions, winding);
}

size_t find_inner_outline(const StripView& strips, const uint32_t* vertex, const uint8_t* winding, uint64_t* found,
                          const OutlineList& outline) {
  return HWY_DYNAMIC_DISPATCH(find_inner_outline)(strips, vertex, winding, found, outline);
}

size_t find_row_edges(const OutlineList& outline, size_t count, const float* pixels, const SampledRows& rows,
                      const RowEdges& edges) {
  return HWY_DYNAMIC_DISPATCH(find_row_edges)(outline, count, pixels, rows, edges);
}

size_t cross_rows(const RowEdges& edges, size_t count, const SampledRows& rows, Crossing* crossings, int32_t* row) {
  return HWY_DYNAMIC_DISPATCH(cross_rows)(edges, count, rows, crossings, row);
}

size_t find_span_ends(const RowGroup* groups, size_t num_groups, GroupCrossings* crossings, const EndLists& ends) {
  return HWY_DYNAMIC_DISPATCH(find_span_ends)(groups, num_groups, crossings, ends);
}

}  // namespace silpose
#endif  // HWY_ONCE
