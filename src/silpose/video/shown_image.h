// From an image as a video stores it to the image as a player shows it: turned upright, of square pixels, without
// the comb of two interlaced fields.
// Threads: functions without state.
#pragma once

#include <cstdint>
#include <opencv2/core.hpp>
#include <optional>
#include <span>

#include "silpose/image/image.h"

namespace silpose {

// Axes are exchanged first, then mirrored. All quarter turns and their mirror images are of this form.
struct Turn {
  bool swaps_axes = false, mirrors_x = false, mirrors_y = false;
};

// Of the display matrix of MP4 and QuickTime (x right, y down; 3x3, row by row, as FFmpeg's libavutil/display.h gives
// it). Nothing: no quarter turn.
std::optional<Turn> turn_of_matrix(std::span<const int32_t, 9> matrix);

// How wide pixels are for their height, as far as it matters: 1 within 1 %, and where it is implausible (beyond 4).
double believed_pixel_aspect(double aspect);

// Lines of the field that comes second give way to the mean of those around them. [H, W, 3]
void keep_one_field(cv::Mat& image, bool top_field_first);

// `stored` [H, W, 3] of pixels `pixel_aspect` wide for their height, widened or heightened to square ones, then turned.
ByteImage shown_image(const cv::Mat& stored, double pixel_aspect, const Turn& turn);

}  // namespace silpose
