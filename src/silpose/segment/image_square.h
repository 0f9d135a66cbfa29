// ImageSquare: a square of an image, which may be rotated, that a network sees, and the network's output mapped back
// to its place. Points are in pixels whose corners are whole numbers: the middle of the first is (0.5, 0.5).
// Threads: values and functions without state.
#pragma once

#include <array>
#include <tuple>
#include <vector>

#include "silpose/image/image.h"

namespace silpose {

struct ImageSquare {
  double x = 0, y = 0;  // its middle
  double side = 0;      // may reach beyond the image
  double turn_rad = 0;  // clockwise on the screen; 0: upright

  // A point of the square, from (0, 0) top left to (1, 1) bottom right, in the image.
  [[nodiscard]] std::array<double, 2> in_image(double u, double v) const;

  static auto members(auto& s) { return std::tie(s.x, s.y, s.side, s.turn_rad); }
};

// Of `side` = 2.5 times the distance from (x, y), its middle, to (up_x, up_y), which lies straight above in it.
ImageSquare square_around(double x, double y, double up_x, double up_y);

// [size, size, 3] R, G, B from 0 to 1 of an image [H, W, 3] in B, G, R, smoothed before it is made smaller; 0 outside
// of the image. REQUIRES: a positive side.
std::vector<float> sample_square(const ByteImage& image, const ImageSquare& square, int size);

// `values` [size, size] of the square, interpolated, in an image of width x height; `elsewhere` outside of the square.
Image<float> values_in_image(const std::vector<float>& values, int size, const ImageSquare& square, int width,
                             int height, float elsewhere);

}  // namespace silpose
