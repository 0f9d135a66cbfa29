// The colour of a coloured screen (chroma key): as the user names it, or found in the clip.
// Threads: functions without state.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "silpose/base/result.h"
#include "silpose/image/image.h"
#include "silpose/image/mask.h"
#include "silpose/segment/background_model.h"

namespace silpose {

using KeyColour = std::array<uint8_t, 3>;  // R, G, B

// "#00b140", or "auto", which is nothing. Errors: anything else, a grey.
Result<std::optional<KeyColour>> parse_key_colour(const std::string& text);

// Y, and Cr and Cb around 0; grey levels.
struct LumaChroma {
  float luma = 0, cr = 0, cb = 0;
  [[nodiscard]] float chroma() const { return std::hypot(cr, cb); }
};

// Of an image in Y, Cr, Cb. REQUIRES: inside the image.
inline LumaChroma luma_chroma_at(const ByteImage& image, int x, int y) {
  return {static_cast<float>(image.at(x, y, 0)), static_cast<float>(image.at(x, y, 1)) - 128,
          static_cast<float>(image.at(x, y, 2)) - 128};
}

KeyColour to_key(const LumaChroma& colour);

struct Dominant {
  LumaChroma mean;
  float share = 0;  // of the pixels
};

// Without a key the mean colour of the commonest saturated hue, where the image's border counts double, and skin's
// and wood's hues do not; with a key that of the saturated pixels of its hue. Pixels that are not set in `keep` are
// ignored. REQUIRES: at least one sample.
Dominant dominant_colour(const BackgroundSamples& samples, const std::optional<KeyColour>& key,
                         const std::optional<Mask>& keep = {});

}  // namespace silpose
