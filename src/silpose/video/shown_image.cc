#include "silpose/video/shown_image.h"

#include <cmath>
#include <cstdlib>
#include <opencv2/imgproc.hpp>

namespace silpose {

std::optional<Turn> turn_of_matrix(std::span<const int32_t, 9> matrix) {
  // x' = a x + c y, y' = b x + d y.
  const double a = matrix[0], b = matrix[1], c = matrix[3], d = matrix[4];
  const auto is_nil = [](double small, double large) { return std::abs(small) < 0.05 * std::abs(large); };
  if (a != 0 && d != 0 && is_nil(b, a) && is_nil(c, d)) return Turn{false, a < 0, d < 0};
  if (b != 0 && c != 0 && is_nil(a, b) && is_nil(d, c)) return Turn{true, c < 0, b < 0};
  return std::nullopt;
}

double believed_pixel_aspect(double aspect) {
  constexpr double kNotSeen = 0.01, kLargest = 4;
  if (!(aspect >= 1 / kLargest && aspect <= kLargest)) return 1;
  return std::abs(aspect - 1) <= kNotSeen ? 1 : aspect;
}

void keep_one_field(cv::Mat& image, bool top_field_first) {
  for (int y = top_field_first ? 1 : 0; y < image.rows; y += 2) {
    const cv::Mat above = image.row(y > 0 ? y - 1 : 1), below = image.row(y + 1 < image.rows ? y + 1 : y - 1);
    cv::Mat line = image.row(y);
    cv::addWeighted(above, 0.5, below, 0.5, 0, line);
  }
}

ByteImage shown_image(const cv::Mat& stored, double pixel_aspect, const Turn& turn) {
  cv::Mat square = stored;
  if (pixel_aspect > 1) {
    cv::resize(stored, square, cv::Size(static_cast<int>(std::lround(stored.cols * pixel_aspect)), stored.rows), 0, 0,
               cv::INTER_CUBIC);
  } else if (pixel_aspect < 1) {
    cv::resize(stored, square, cv::Size(stored.cols, static_cast<int>(std::lround(stored.rows / pixel_aspect))), 0, 0,
               cv::INTER_CUBIC);
  }
  const cv::Size size = turn.swaps_axes ? cv::Size(square.rows, square.cols) : square.size();
  ByteImage image(size.width, size.height, 3);
  cv::Mat shown(size, CV_8UC3, image.pixels().data());
  if (turn.swaps_axes) {
    cv::transpose(square, shown);
    square = shown;
  }
  if (turn.mirrors_x || turn.mirrors_y) {
    cv::flip(square, shown, turn.mirrors_x && turn.mirrors_y ? -1 : turn.mirrors_x ? 1 : 0);
  } else if (!turn.swaps_axes) {
    square.copyTo(shown);
  }
  return image;
}

}  // namespace silpose
