// What the drawing functions share: an OpenCV view of an image, line widths, colours, and points in OpenCV's fixed
// point. For use inside module render. Threads: pure functions.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>

#include "silpose/base/check.h"
#include "silpose/body/rig_profile.h"
#include "silpose/image/image.h"
#include "silpose/render/colour.h"

namespace silpose {

inline constexpr int kFractionBits = 4;  // of the coordinates that OpenCV draws with

// REQUIRES: image of 3 channels, which outlives the view.
inline cv::Mat canvas_of(ByteImage& image) {
  check(image.channels() == 3, "drawing on an image of {} channels", image.channels());
  return {image.height(), image.width(), CV_8UC3, image.pixels().data()};
}

// Lines and dots that keep their weight whatever the image's size.
inline int line_width(const ByteImage& image) {
  return std::max(1, static_cast<int>(std::lround(image.height() / 360.0)));
}

inline cv::Point fixed_point(const Eigen::Vector2d& pixel) {
  static constexpr double kFar = 16384;  // what lies further out is not seen anyway, and would overflow
  const auto fixed = [](double value) {
    return static_cast<int>(std::lround((std::clamp(value, -kFar, kFar) - 0.5) * (1 << kFractionBits)));
  };
  return {fixed(pixel.x()), fixed(pixel.y())};
}

inline cv::Scalar scalar_of(Colour colour) { return {double(colour[0]), double(colour[1]), double(colour[2])}; }

// Of parts of a body: left blue, right orange, the rest white.
inline Colour colour_of(BodySide side) {
  if (side == BodySide::kLeft) return {255, 150, 40};
  if (side == BodySide::kRight) return {30, 140, 255};
  return {245, 245, 245};
}

}  // namespace silpose
