#include "silpose/render/skin_kernels.h"

#include "silpose/geometry/camera.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "silpose/render/skin_kernels.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace silpose {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, kChunkLanes>;
constexpr Floats kFloats;
constexpr size_t kStep = hn::MaxLanes(Floats());

using FloatsV = hn::Vec<Floats>;

// Calls store(chunk, lane, x, y, depth) with the pixels of kStep vertices at a time.
template <class Store>
HWY_INLINE void for_each_projected(const SkinView& skin, const Store& store) {
  const auto one = hn::Set(kFloats, 1.0f);
  for (size_t c = 0; c < skin.num_chunks; ++c) {
    for (size_t lane = 0; lane < kChunkLanes; lane += kStep) {
      auto x = hn::Zero(kFloats), y = x, z = x;
      for (uint32_t e = skin.chunks[c].begin; e < skin.chunks[c].end; ++e) {
        const float* const m = skin.matrices + size_t{12} * skin.entry_joint[e];
        const SkinEntry& entry = skin.entries[e];
        const auto ex = hn::Load(kFloats, entry.x.lane + lane), ey = hn::Load(kFloats, entry.y.lane + lane);
        const auto ez = hn::Load(kFloats, entry.z.lane + lane), ew = hn::Load(kFloats, entry.w.lane + lane);
        const auto add_row = [&](const float* row, FloatsV sum) HWY_ATTR {
          const auto near_part = hn::MulAdd(hn::Set(kFloats, row[1]), ey, hn::Mul(hn::Set(kFloats, row[0]), ex));
          const auto far_part = hn::MulAdd(hn::Set(kFloats, row[2]), ez, hn::Mul(hn::Set(kFloats, row[3]), ew));
          return hn::Add(sum, hn::Add(near_part, far_part));
        };
        x = add_row(m, x);
        y = add_row(m + 4, y);
        z = add_row(m + 8, z);
      }
      const auto inverse_depth = hn::Div(one, z);
      store(c, lane, hn::Mul(x, inverse_depth), hn::Mul(y, inverse_depth), z);
    }
  }
}

HWY_INLINE hn::VFromD<hn::RebindToSigned<Floats>> round_axis(const GridAxis& axis, FloatsV pixel) {
  const hn::RebindToSigned<Floats> d32;
  constexpr auto kLimit = static_cast<float>(kGridLimit);
  const auto lowest = hn::Set(kFloats, -kLimit), highest = hn::Set(kFloats, kLimit);
  auto grid = hn::Add(hn::Mul(pixel, hn::Set(kFloats, axis.slope)), hn::Set(kFloats, axis.offset));
  grid = hn::IfThenElse(hn::Gt(grid, lowest), grid, lowest);
  grid = hn::IfThenElse(hn::Lt(grid, highest), grid, highest);
  const auto whole = hn::ConvertTo(d32, grid);
  const auto rest = hn::Sub(grid, hn::ConvertTo(kFloats, whole));
  return hn::Add(whole, hn::ConvertTo(d32, hn::Add(rest, rest)));
}

void skin_and_project(const SkinView& skin, ChunkFloats* HWY_RESTRICT out_x, ChunkFloats* HWY_RESTRICT out_y,
                      ChunkFloats* HWY_RESTRICT out_depth) {
  for_each_projected(skin, [&](size_t c, size_t lane, FloatsV x, FloatsV y, FloatsV depth) HWY_ATTR {
    hn::Store(x, kFloats, out_x[c].lane + lane);
    hn::Store(y, kFloats, out_y[c].lane + lane);
    hn::Store(depth, kFloats, out_depth[c].lane + lane);
  });
}

bool skin_and_round(const SkinView& skin, const GridAxis& x_axis, const GridAxis& y_axis,
                    GridPoint* HWY_RESTRICT points) {
  const hn::RebindToSigned<Floats> d32;
  const auto nearest_seen = hn::Set(kFloats, static_cast<float>(PinholeCamera::kNear));
  auto all_seen = hn::FirstN(kFloats, kStep);
  for_each_projected(skin, [&](size_t c, size_t lane, FloatsV x, FloatsV y, FloatsV depth) HWY_ATTR {
    all_seen = hn::And(all_seen, hn::Ge(depth, nearest_seen));
    hn::StoreInterleaved2(round_axis(x_axis, x), round_axis(y_axis, y), d32, &points[c * kChunkLanes + lane].x);
  });
  return hn::AllTrue(kFloats, all_seen);
}

bool skin_to_pixels(const SkinView& skin, float* HWY_RESTRICT xy) {
  const auto nearest_seen = hn::Set(kFloats, static_cast<float>(PinholeCamera::kNear));
  auto all_seen = hn::FirstN(kFloats, kStep);
  for_each_projected(skin, [&](size_t c, size_t lane, FloatsV x, FloatsV y, FloatsV depth) HWY_ATTR {
    all_seen = hn::And(all_seen, hn::Ge(depth, nearest_seen));
    hn::StoreInterleaved2(x, y, kFloats, xy + 2 * (c * kChunkLanes + lane));
  });
  return hn::AllTrue(kFloats, all_seen);
}

void distort_points(const LensFloats& lens, size_t num_chunks, ChunkFloats* HWY_RESTRICT inout_x,
                    ChunkFloats* HWY_RESTRICT inout_y) {
  const auto number = [](float value) HWY_ATTR { return hn::Set(kFloats, value); };
  for (size_t c = 0; c < num_chunks; ++c) {
    for (size_t lane = 0; lane < kChunkLanes; lane += kStep) {
      const auto x = hn::Load(kFloats, inout_x[c].lane + lane), y = hn::Load(kFloats, inout_y[c].lane + lane);
      const auto xx = hn::Mul(x, x), yy = hn::Mul(y, y), xy = hn::Mul(x, y), r2 = hn::Add(xx, yy);
      const auto inner = hn::MulAdd(r2, number(lens.k[4]), number(lens.k[1]));
      const auto radial = hn::MulAdd(r2, hn::MulAdd(r2, inner, number(lens.k[0])), number(1.0f));
      const auto by_x = hn::Mul(number(lens.k[3]), hn::MulAdd(number(2.0f), xx, r2));
      const auto by_y = hn::Mul(number(lens.k[2]), hn::MulAdd(number(2.0f), yy, r2));
      const auto bent_x = hn::MulAdd(x, radial, hn::MulAdd(number(2 * lens.k[2]), xy, by_x));
      const auto bent_y = hn::MulAdd(y, radial, hn::MulAdd(number(2 * lens.k[3]), xy, by_y));
      hn::Store(hn::MulAdd(number(lens.fx), bent_x, number(lens.cx)), kFloats, inout_x[c].lane + lane);
      hn::Store(hn::MulAdd(number(lens.fy), bent_y, number(lens.cy)), kFloats, inout_y[c].lane + lane);
    }
  }
}

ProjectionBounds bounds_of_points(size_t num_chunks, const ChunkFloats* HWY_RESTRICT x,
                                  const ChunkFloats* HWY_RESTRICT y, const ChunkFloats* HWY_RESTRICT depth) {
  const auto nearest_seen = hn::Set(kFloats, static_cast<float>(PinholeCamera::kNear));
  auto x0 = hn::Load(kFloats, x[0].lane), x1 = x0, y0 = hn::Load(kFloats, y[0].lane), y1 = y0;
  auto all_seen = hn::FirstN(kFloats, kStep);
  for (size_t c = 0; c < num_chunks; ++c) {
    for (size_t lane = 0; lane < kChunkLanes; lane += kStep) {
      const auto px = hn::Load(kFloats, x[c].lane + lane), py = hn::Load(kFloats, y[c].lane + lane);
      x0 = hn::Min(x0, px);
      x1 = hn::Max(x1, px);
      y0 = hn::Min(y0, py);
      y1 = hn::Max(y1, py);
      all_seen = hn::And(all_seen, hn::Ge(hn::Load(kFloats, depth[c].lane + lane), nearest_seen));
    }
  }
  return {hn::GetLane(hn::MinOfLanes(kFloats, x0)), hn::GetLane(hn::MinOfLanes(kFloats, y0)),
          hn::GetLane(hn::MaxOfLanes(kFloats, x1)), hn::GetLane(hn::MaxOfLanes(kFloats, y1)),
          hn::AllTrue(kFloats, all_seen)};
}

void round_points(const GridAxis& x_axis, const GridAxis& y_axis, size_t num_chunks, const ChunkFloats* HWY_RESTRICT x,
                  const ChunkFloats* HWY_RESTRICT y, GridPoint* HWY_RESTRICT points) {
  const hn::RebindToSigned<Floats> d32;
  for (size_t c = 0; c < num_chunks; ++c) {
    for (size_t lane = 0; lane < kChunkLanes; lane += kStep) {
      hn::StoreInterleaved2(round_axis(x_axis, hn::Load(kFloats, x[c].lane + lane)),
                            round_axis(y_axis, hn::Load(kFloats, y[c].lane + lane)), d32,
                            &points[c * kChunkLanes + lane].x);
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace silpose
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace silpose {
namespace {

HWY_EXPORT(skin_and_project);
HWY_EXPORT(skin_and_round);
HWY_EXPORT(skin_to_pixels);
HWY_EXPORT(distort_points);
HWY_EXPORT(bounds_of_points);
HWY_EXPORT(round_points);

}  // namespace

void skin_and_project(const SkinView& skin, ChunkFloats* x, ChunkFloats* y, ChunkFloats* depth) {
  HWY_DYNAMIC_DISPATCH(skin_and_project)(skin, x, y, depth);
}

bool skin_and_round(const SkinView& skin, const GridAxis& x_axis, const GridAxis& y_axis, GridPoint* points) {
  return HWY_DYNAMIC_DISPATCH(skin_and_round)(skin, x_axis, y_axis, points);
}

bool skin_to_pixels(const SkinView& skin, float* xy) { return HWY_DYNAMIC_DISPATCH(skin_to_pixels)(skin, xy); }

void distort_points(const LensFloats& lens, size_t num_chunks, ChunkFloats* x, ChunkFloats* y) {
  HWY_DYNAMIC_DISPATCH(distort_points)(lens, num_chunks, x, y);
}

ProjectionBounds bounds_of_points(size_t num_chunks, const ChunkFloats* x, const ChunkFloats* y,
                                  const ChunkFloats* depth) {
  return HWY_DYNAMIC_DISPATCH(bounds_of_points)(num_chunks, x, y, depth);
}

void round_points(const GridAxis& x_axis, const GridAxis& y_axis, size_t num_chunks, const ChunkFloats* x,
                  const ChunkFloats* y, GridPoint* points) {
  HWY_DYNAMIC_DISPATCH(round_points)(x_axis, y_axis, num_chunks, x, y, points);
}

}  // namespace silpose
#endif  // HWY_ONCE
