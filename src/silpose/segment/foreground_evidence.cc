#include "silpose/segment/foreground_evidence.h"

#include <algorithm>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "silpose/segment/foreground_evidence.cc"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

#ifndef SILPOSE_SEGMENT_FOREGROUND_EVIDENCE_ONCE
#define SILPOSE_SEGMENT_FOREGROUND_EVIDENCE_ONCE
namespace silpose {
namespace {

// A pixel is foreground by itself from this chi-square distance on (3 channels). With noise of 3 grey levels that is
// where the background's Gaussian falls below a foreground of any colour, equally likely. [tuned on rendered clips: 18
// and 26 were no better]
constexpr float kThreshold = 22;
// A small difference that a whole window shows counts as well. Noise of coded video is alike in neighbours: the mean of
// nine pixels has half the variance of one, not a ninth.
// Not where the pixel itself shows almost no difference: there the window extends over the subject's edge.
// [tuned on rendered clips of recorded motions: dance, jumping, kick, punch]
constexpr float kWindowWeight = 2, kWindowMost = 10;
constexpr float kMostFor = 6;  // [guess] as kMostAgainst
// Shadows darken to a third at most: the deviation of the factor. Light thrown back brightens far less. [guess]
constexpr float kShadowDeviation = 0.15f, kGlowDeviation = 0.04f, kMostFactor = 1.5f;
// A shadow keeps the background's texture: the weight of what is left over, in noise variances. [guess]
constexpr float kTextureWeight = 3;

constexpr size_t kReach = kTextureReach;

}  // namespace
}  // namespace silpose
#endif

HWY_BEFORE_NAMESPACE();
namespace silpose::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

// Calls body(tag, x) for the vectors of a row; the last overlaps the one before it. Rows shorter than a vector go pixel
// by pixel.
template <class Element, class Body>
HWY_INLINE void for_each_vector(size_t width, const Body& body) {
  const hn::ScalableTag<Element> whole;
  const size_t lanes = hn::Lanes(whole);
  if (width < lanes) {
    for (size_t x = 0; x < width; ++x) body(hn::CappedTag<Element, 1>(), x);
    return;
  }
  for (size_t x = 0; x + lanes <= width; x += lanes) body(whole, x);
  if (width % lanes != 0) body(whole, width - lanes);
}

template <class D>
HWY_INLINE hn::Vec<D> widened(D d, hn::Vec<hn::Rebind<uint8_t, D>> bytes) {
  if constexpr (hwy::IsFloat<hn::TFromD<D>>()) {
    return hn::ConvertTo(d, hn::PromoteTo(hn::Rebind<int32_t, D>(), bytes));
  } else {
    return hn::PromoteTo(d, bytes);
  }
}

// The luma of pixels [W, 3], from pixel x on.
template <class D>
HWY_INLINE hn::Vec<D> luma_at(D d, const uint8_t* pixels, size_t x) {
  const hn::Rebind<uint8_t, D> of_bytes;
  hn::Vec<decltype(of_bytes)> luma, red, blue;
  hn::LoadInterleaved3(of_bytes, pixels + 3 * x, luma, red, blue);
  return widened(d, luma);
}

HWY_ATTR void compare_texture_row(const TextureRows& rows, size_t width, int32_t* sums, float* texture) {
  // Sums over the columns of the window, with kReach empty ones on either side.
  const size_t padded = width + 2 * kReach;
  int32_t *const seen_seen = sums, *const seen_back = sums + padded, *const back_back = sums + 2 * padded;
  for (int32_t* of_row : {seen_seen, seen_back, back_back}) {
    std::fill_n(of_row, kReach, 0);
    std::fill_n(of_row + kReach + width, kReach, 0);
  }
  for_each_vector<int32_t>(width, [&](auto d, size_t x) HWY_ATTR {
    auto ss = hn::Zero(d), sb = ss, bb = ss;
    for (size_t r = 0; r < rows.count; ++r) {
      const auto s = luma_at(d, rows.seen[r], x), b = luma_at(d, rows.background[r], x);
      ss = hn::Add(ss, hn::Mul(s, s));
      sb = hn::Add(sb, hn::Mul(s, b));
      bb = hn::Add(bb, hn::Mul(b, b));
    }
    hn::StoreU(ss, d, seen_seen + kReach + x);
    hn::StoreU(sb, d, seen_back + kReach + x);
    hn::StoreU(bb, d, back_back + kReach + x);
  });
  for_each_vector<double>(width, [&](auto d, size_t x) HWY_ATTR {
    const hn::Rebind<int32_t, decltype(d)> whole;
    const hn::Rebind<float, decltype(d)> single;
    const auto over_window = [&](const int32_t* of_columns) HWY_ATTR {
      auto sum = hn::Zero(whole);
      for (size_t i = 0; i <= 2 * kReach; ++i) sum = hn::Add(sum, hn::LoadU(whole, of_columns + x + i));
      return sum;
    };
    const auto seen = hn::PromoteTo(d, over_window(seen_seen)), both = hn::PromoteTo(d, over_window(seen_back));
    const auto back = hn::PromoteTo(d, hn::Max(over_window(back_back), hn::Set(whole, 1)));
    const auto left = hn::Sub(seen, hn::Div(hn::Mul(both, both), back));
    const auto count = hn::Set(single, static_cast<float>((2 * kReach + 1) * rows.count));
    hn::StoreU(hn::Div(hn::DemoteTo(single, left), count), single, texture + x);
  });
  // Windows that the border cuts have fewer pixels.
  for (size_t x = 0; x < width; ++x) {
    if (x == kReach && width > 2 * kReach) x = width - kReach;
    const size_t columns = std::min(x + kReach, width - 1) - (x - std::min(x, kReach)) + 1;
    texture[x] *= static_cast<float>(2 * kReach + 1) / static_cast<float>(columns);
  }
}

// Three channels, from pixel x on, less `centre` of each.
template <class D>
struct Colour {
  hn::Vec<D> luma, red, blue;
};
template <class D>
HWY_INLINE Colour<D> colour_at(D d, const uint8_t* pixels, size_t x) {
  const hn::Rebind<uint8_t, D> of_bytes;
  hn::Vec<decltype(of_bytes)> luma, red, blue;
  hn::LoadInterleaved3(of_bytes, pixels + 3 * x, luma, red, blue);
  const auto centre = hn::Set(d, 128.0f);
  return {widened(d, luma), hn::Sub(widened(d, red), centre), hn::Sub(widened(d, blue), centre)};
}

HWY_ATTR void weigh_evidence_row(const EvidenceRow& row, float* least, float* evidence, uint8_t* differs) {
  // The least of the windows that hold the pixel: those next to it avoid the subject's edge.
  for_each_vector<float>(row.width, [&](auto d, size_t x) HWY_ATTR {
    auto of_rows = hn::LoadU(d, row.texture[0] + x);
    for (size_t r = 1; r < row.texture.size(); ++r) of_rows = hn::Min(of_rows, hn::LoadU(d, row.texture[r] + x));
    hn::StoreU(of_rows, d, least + kReach + x);
  });
  std::fill_n(least, kReach, least[kReach]);
  std::fill_n(least + kReach + row.width, kReach, least[kReach + row.width - 1]);

  for_each_vector<float>(row.width, [&](auto d, size_t x) HWY_ATTR {
    using Vector = hn::Vec<decltype(d)>;
    const auto set = [&](float value) HWY_ATTR { return hn::Set(d, value); };
    const auto square = [](Vector v) HWY_ATTR { return hn::Mul(v, v); };
    const Vector gain = set(row.gain);
    const auto lit = [&](const uint8_t* pixels) HWY_ATTR {
      const auto colour = colour_at(d, pixels, x);
      return Colour<decltype(d)>{hn::Mul(gain, colour.luma), hn::Mul(gain, colour.red), hn::Mul(gain, colour.blue)};
    };
    const auto seen = colour_at(d, row.seen, x), back = lit(row.background);
    const auto seen_around = colour_at(d, row.seen_around, x), back_around = lit(row.background_around);
    const Vector weight_y = hn::LoadU(d, row.inverse_noise[0] + x), weight_r = hn::LoadU(d, row.inverse_noise[1] + x),
                 weight_b = hn::LoadU(d, row.inverse_noise[2] + x);
    const auto distance = [&](const auto& a, const auto& b) HWY_ATTR {
      return hn::Add(
          hn::Add(hn::Mul(square(hn::Sub(a.luma, b.luma)), weight_y), hn::Mul(square(hn::Sub(a.red, b.red)), weight_r)),
          hn::Mul(square(hn::Sub(a.blue, b.blue)), weight_b));
    };
    const Vector here = distance(seen, back), around = distance(seen_around, back_around);
    const Vector plain = hn::Max(here, hn::Min(hn::Mul(set(kWindowWeight), around), hn::Mul(set(kWindowMost), here)));

    const Vector factor = hn::Min(hn::Div(seen.luma, hn::Max(back.luma, set(1))), set(kMostFactor));
    const Vector deviation = hn::IfThenElse(hn::Lt(factor, set(1)), set(1 / kShadowDeviation), set(1 / kGlowDeviation));
    Vector shadow = square(hn::Mul(hn::Sub(factor, set(1)), deviation));
    shadow = hn::Add(shadow, hn::Mul(square(hn::Sub(seen.red, hn::Mul(factor, back.red))), weight_r));
    shadow = hn::Add(shadow, hn::Mul(square(hn::Sub(seen.blue, hn::Mul(factor, back.blue))), weight_b));
    Vector texture = hn::LoadU(d, least + x);
    for (size_t i = 1; i <= 2 * kReach; ++i) texture = hn::Min(texture, hn::LoadU(d, least + x + i));
    const Vector left = hn::Max(hn::Sub(hn::Mul(texture, weight_y), set(1)), hn::Zero(d));
    shadow = hn::Add(shadow, hn::Mul(set(kTextureWeight), left));

    const Vector half = hn::Mul(set(0.5f), hn::Sub(hn::Min(plain, shadow), set(kThreshold)));
    hn::StoreU(hn::Min(hn::Max(half, set(-kMostAgainst)), set(kMostFor)), d, evidence + x);
    const hn::Rebind<int32_t, decltype(d)> whole;
    const auto is_other = hn::RebindMask(whole, hn::Gt(plain, set(kThreshold)));
    const hn::Rebind<uint8_t, decltype(d)> bytes;
    hn::StoreU(hn::DemoteTo(bytes, hn::IfThenElseZero(is_other, hn::Set(whole, 1))), bytes, differs + x);
  });
}

}  // namespace silpose::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace silpose {

HWY_EXPORT(compare_texture_row);
HWY_EXPORT(weigh_evidence_row);

size_t texture_sums_size(size_t width) { return 3 * (width + 2 * kReach); }

void compare_texture_row(const TextureRows& rows, size_t width, int32_t* sums, float* texture) {
  HWY_DYNAMIC_DISPATCH(compare_texture_row)(rows, width, sums, texture);
}

void weigh_evidence_row(const EvidenceRow& row, float* least, float* evidence, uint8_t* differs) {
  HWY_DYNAMIC_DISPATCH(weigh_evidence_row)(row, least, evidence, differs);
}

}  // namespace silpose
#endif  // HWY_ONCE
