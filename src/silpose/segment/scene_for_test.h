// A small scene to segment in tests: a textured backdrop with noise, a bright subject that walks, its soft shadow.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "silpose/base/rng.h"
#include "silpose/image/image_file.h"
#include "silpose/image/mask.h"
#include "silpose/video/video.h"

namespace silpose {

struct TestScene {
  int width = 160, height = 120;
  double noise = 2;     // grey levels
  double shadow = 0;    // 0: none; 0.3: darkens the floor next to the subject by that fraction
  double exposure = 1;  // of the whole image

  [[nodiscard]] ByteImage backdrop() const {
    ByteImage image(width, height, 3);
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        const double wave = 20 * std::sin(0.2 * x) * std::cos(0.15 * y) + (((x / 12) + (y / 12)) % 2 == 0 ? 12 : -12);
        const double level[3] = {110 + wave, 130 + wave, 120 + 0.8 * wave};
        for (int c = 0; c < 3; ++c) image.at(x, y, c) = static_cast<uint8_t>(std::clamp(level[c], 0.0, 255.0));
      }
    }
    return image;
  }

  // 24 x 60 pixels, the left edge at x.
  [[nodiscard]] Mask subject(int x) const {
    Mask mask(width, height);
    for (int v = 30; v < 90; ++v) {
      for (int u = std::max(x, 0); u < std::min(x + 24, width); ++u) mask.set(u, v);
    }
    return mask;
  }

  // Without a subject where x is outside the image.
  [[nodiscard]] ByteImage image(int x, uint64_t seed) const {
    ByteImage image = backdrop();
    const Mask mask = subject(x);
    Rng rng(seed);
    for (int v = 0; v < height; ++v) {
      for (int u = 0; u < width; ++u) {
        const bool in_shadow = shadow > 0 && v >= 70 && v < 95 && u >= x + 24 && u < x + 54;
        const double subject_level[3] = {60.0 + (v % 8), 70.0 + (u % 5), 190.0};
        for (int c = 0; c < 3; ++c) {
          double level = mask.get(u, v) ? subject_level[c] : image.at(u, v, c) * (in_shadow ? 1 - shadow : 1);
          level = exposure * level + noise * rng.normal();
          image.at(u, v, c) = static_cast<uint8_t>(std::clamp(std::lround(level), 0L, 255L));
        }
      }
    }
    return image;
  }
};

}  // namespace silpose
