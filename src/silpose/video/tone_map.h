// HDR images (ITU-R BT.2100: wide primaries; hybrid log-gamma, HLG, or perceptual quantizer, PQ) as a screen of
// standard range shows them: 8-bit sRGB. A diffuse white of 203 cd/m2 is the standard white; up to about half of that
// colours are as they were, above they roll off towards 1,000 cd/m2, which comes out as white. Colours keep their hue;
// what the smaller gamut lacks is cut.
// Source: the systems and their curves (references.bib: bt2100), the roll-off (sect. 5.4 of references.bib: bt2390),
// diffuse white (references.bib: bt2408), from wide primaries (references.bib: bt2407), the screen's curve
// (references.bib: srgb).
// Threads: constant after construction.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace silpose {

enum class HdrTransfer { kHlg, kPq };

// One colour R', G', B', each 0 to 1 as coded, in sRGB as coded, each 0 to 1.
std::array<double, 3> sdr_colour(HdrTransfer transfer, const std::array<double, 3>& coded);

// The same for many, by tables: within a grey level.
class ToneMap {
 public:
  static constexpr int kBits = 10;

  explicit ToneMap(HdrTransfer transfer);

  // A row of an image: [W] of each channel, of kBits, to B, G, R [3 W].
  void apply(std::span<const uint16_t> red, std::span<const uint16_t> green, std::span<const uint16_t> blue,
             std::span<uint8_t> shown) const;

 private:
  static constexpr int kMost = (1 << kBits) - 1;
  std::vector<float> light_;         // of each code
  std::vector<float> of_luminance_;  // gain of the screen by the scene's luminance; empty: light is the screen's
  std::vector<float> of_brightest_;  // gain by the light of the brightest channel
  std::vector<uint8_t> shown_;       // of linear light, the screen's white 1
};

}  // namespace silpose
