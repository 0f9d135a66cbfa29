// Window: which part of the image is drawn, and how fine. Raster pixel (i, j) has its centre at image point
// (x0 + (i + 0.5) / scale_x, y0 + (j + 0.5) / scale_y), image points as in geometry/camera.h.
// Threads: values.
#pragma once

namespace silpose {

struct Window {
  double x0 = 0, y0 = 0;            // image pixels: where the raster's top-left corner lies
  double scale_x = 1, scale_y = 1;  // raster pixels per image pixel
  int width = 0, height = 0;        // raster pixels
};

// A pixel's coverage by a silhouette is the number of its samples inside, 0 to kFullCoverage: kCoverageSamples along
// each axis. [definition]
inline constexpr int kCoverageSamples = 8, kFullCoverage = kCoverageSamples * kCoverageSamples;

// The window whose pixels are a window's samples.
[[nodiscard]] inline Window sample_window(const Window& window) {
  return {.x0 = window.x0,
          .y0 = window.y0,
          .scale_x = window.scale_x * kCoverageSamples,
          .scale_y = window.scale_y * kCoverageSamples,
          .width = window.width * kCoverageSamples,
          .height = window.height * kCoverageSamples};
}

// A box [x0, x1] x [y0, y1] of image points.
struct PixelBounds {
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

}  // namespace silpose
