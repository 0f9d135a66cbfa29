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

// A box [x0, x1] x [y0, y1] of image points.
struct PixelBounds {
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
};

}  // namespace silpose
