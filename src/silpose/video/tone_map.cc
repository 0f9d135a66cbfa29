#include "silpose/video/tone_map.h"

#include <algorithm>
#include <bit>
#include <cmath>

namespace silpose {
namespace {

constexpr double kDiffuseWhite = 203, kPeak = 1000;  // cd/m2
constexpr double kSystemGamma = 1.2;                 // of HLG on a screen of kPeak
// BT.2407: linear, from the wide primaries to those of sRGB.
constexpr float kNarrow[3][3] = {
    {1.6605f, -0.5876f, -0.0728f}, {-0.1246f, 1.1329f, -0.0083f}, {-0.0182f, -0.1006f, 1.1187f}};
constexpr float kLuminance[3] = {0.2627f, 0.6780f, 0.0593f};  // of the wide primaries

// BT.2100: light in cd/m2, 0 to 10,000, from PQ, and back.
constexpr double kM1 = 2610.0 / 16384, kM2 = 2523.0 / 4096 * 128, kC1 = 3424.0 / 4096, kC2 = 2413.0 / 4096 * 32,
                 kC3 = 2392.0 / 4096 * 32;
double light_of_pq(double coded) {
  const double p = std::pow(coded, 1 / kM2);
  return 10000 * std::pow(std::max(p - kC1, 0.0) / (kC2 - kC3 * p), 1 / kM1);
}
double pq_of_light(double light) {
  const double p = std::pow(light / 10000, kM1);
  return std::pow((kC1 + kC2 * p) / (1 + kC3 * p), kM2);
}

// BT.2100: light of the scene, 0 to 1, from HLG.
double scene_of_hlg(double coded) {
  constexpr double a = 0.17883277, b = 1 - 4 * a, c = 0.55991073;
  return coded <= 0.5 ? coded * coded / 3 : (std::exp((coded - c) / a) + b) / 12;
}

// BT.2390's roll-off from kPeak to kDiffuseWhite, both in cd/m2: a Hermite spline above a knee, in PQ.
double rolled_off(double light) {
  const double peak = pq_of_light(kPeak), most = pq_of_light(kDiffuseWhite) / peak, knee = 1.5 * most - 0.5;
  const double given = std::min(pq_of_light(light) / peak, 1.0);
  if (given < knee) return light;
  const double t = (given - knee) / (1 - knee), t2 = t * t, t3 = t2 * t;
  return light_of_pq(peak * ((2 * t3 - 3 * t2 + 1) * knee + (t3 - 2 * t2 + t) * (1 - knee) + (3 * t2 - 2 * t3) * most));
}

double srgb_of_light(double light) {
  return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1 / 2.4) - 0.055;
}

// By which light is shown, the screen's white 1, where the brightest channel has this much.
double gain_of(double brightest) { return rolled_off(brightest) / (brightest * kDiffuseWhite); }

// Tables over positive numbers, as fine for small as for large ones: by exponent and leading bits of a float.
constexpr int kLeading = 7, kShift = 23 - kLeading;
constexpr float kLeast = 0x1p-16f;

size_t place_in(size_t table_size, float x) {
  const int place = static_cast<int>(std::bit_cast<uint32_t>(std::max(x, kLeast)) >> kShift) -
                    static_cast<int>(std::bit_cast<uint32_t>(kLeast) >> kShift);
  return std::min(static_cast<size_t>(place), table_size - 1);
}
template <class T, class Function>
std::vector<T> table_up_to(float most, const Function& function) {
  std::vector<T> table(place_in(SIZE_MAX, most) + 1);
  for (size_t i = 0; i < table.size(); ++i) {
    const uint32_t bits = ((std::bit_cast<uint32_t>(kLeast) >> kShift) + static_cast<uint32_t>(i)) << kShift;
    table[i] = static_cast<T>(function(static_cast<double>(std::bit_cast<float>(bits | (1u << (kShift - 1))))));
  }
  return table;
}

}  // namespace

std::array<double, 3> sdr_colour(HdrTransfer transfer, const std::array<double, 3>& coded) {
  std::array<double, 3> light{};  // cd/m2, of a screen of kPeak
  for (size_t c = 0; c < 3; ++c)
    light[c] = transfer == HdrTransfer::kPq ? light_of_pq(coded[c]) : scene_of_hlg(coded[c]);
  if (transfer == HdrTransfer::kHlg) {
    const double gain = kPeak * std::pow(kLuminance[0] * light[0] + kLuminance[1] * light[1] + kLuminance[2] * light[2],
                                         kSystemGamma - 1);
    for (double& l : light) l *= gain;
  }
  const double brightest = std::max({light[0], light[1], light[2]});
  if (brightest <= 0) return {};
  const double gain = gain_of(brightest);
  for (double& l : light) l *= gain;
  std::array<double, 3> shown{};
  for (size_t c = 0; c < 3; ++c) {
    const double narrow = kNarrow[c][0] * light[0] + kNarrow[c][1] * light[1] + kNarrow[c][2] * light[2];
    shown[c] = srgb_of_light(std::clamp(narrow, 0.0, 1.0));
  }
  return shown;
}

ToneMap::ToneMap(HdrTransfer transfer) {
  for (int code = 0; code <= kMost; ++code) {
    const double coded = static_cast<double>(code) / kMost;
    light_.push_back(static_cast<float>(transfer == HdrTransfer::kPq ? light_of_pq(coded) : scene_of_hlg(coded)));
  }
  if (transfer == HdrTransfer::kHlg) {
    of_luminance_ = table_up_to<float>(1, [](double x) { return kPeak * std::pow(x, kSystemGamma - 1); });
  }
  of_brightest_ = table_up_to<float>(10000, gain_of);
  shown_ = table_up_to<uint8_t>(1, [](double x) { return std::lround(255 * srgb_of_light(std::min(x, 1.0))); });
}

void ToneMap::apply(std::span<const uint16_t> red, std::span<const uint16_t> green, std::span<const uint16_t> blue,
                    std::span<uint8_t> shown) const {
  for (size_t x = 0; x < red.size(); ++x) {
    float r = light_[red[x] & kMost], g = light_[green[x] & kMost], b = light_[blue[x] & kMost];
    float gain = 1;
    if (!of_luminance_.empty()) {
      const float luminance = kLuminance[0] * r + kLuminance[1] * g + kLuminance[2] * b;
      gain = of_luminance_[place_in(of_luminance_.size(), luminance)];
    }
    gain *= of_brightest_[place_in(of_brightest_.size(), gain * std::max({r, g, b}))];
    r *= gain, g *= gain, b *= gain;
    for (size_t c = 0; c < 3; ++c) {
      const float narrow = kNarrow[c][0] * r + kNarrow[c][1] * g + kNarrow[c][2] * b;
      shown[3 * x + 2 - c] = shown_[place_in(shown_.size(), narrow)];
    }
  }
}

}  // namespace silpose
