#include "silpose/segment/image_square.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

namespace silpose {
namespace {

// The part of the image that the square covers: the box around it, cut to the image; may be empty.
cv::Rect box_around(const ImageSquare& square, int width, int height) {
  const double reach = 0.5 * square.side * (std::abs(std::cos(square.turn_rad)) + std::abs(std::sin(square.turn_rad)));
  const auto low = [&](double at, int size) {
    return static_cast<int>(std::floor(std::clamp(at - reach - 1, 0.0, static_cast<double>(size))));
  };
  const auto high = [&](double at, int size) {
    return static_cast<int>(std::ceil(std::clamp(at + reach + 1, 0.0, static_cast<double>(size))));
  };
  const int x = low(square.x, width), y = low(square.y, height);
  return {x, y, high(square.x, width) - x, high(square.y, height) - y};
}

// Made larger to the left where there is room, so that its width is a multiple of `step`.
void round_up(int& start, int& length, int step) {
  const int missing = std::min((step - length % step) % step, start);
  start -= missing;
  length += missing;
}

}  // namespace

std::array<double, 2> ImageSquare::in_image(double u, double v) const {
  const double c = side * std::cos(turn_rad), s = side * std::sin(turn_rad);
  return {x + c * (u - 0.5) - s * (v - 0.5), y + s * (u - 0.5) + c * (v - 0.5)};
}

ImageSquare square_around(double x, double y, double up_x, double up_y) {
  return {x, y, 2.5 * std::hypot(up_x - x, up_y - y), std::atan2(up_x - x, y - up_y)};
}

std::vector<float> sample_square(const ByteImage& image, const ImageSquare& square, int size) {
  check(image.channels() == 3, "sample_square: {} channels", image.channels());
  check(square.side > 0, "sample_square: side {}", square.side);
  std::vector<float> values(static_cast<size_t>(size) * static_cast<size_t>(size) * 3, 0.0f);
  cv::Rect box = box_around(square, image.width(), image.height());
  if (box.empty()) return values;

  // Whole-number steps by the mean of blocks, which is fast; the rest by a Gaussian as wide as the new pixels ask for.
  const double shrink = square.side / size;
  const int step = std::clamp(static_cast<int>(shrink), 1, std::min(box.width, box.height));
  round_up(box.x, box.width, step);
  round_up(box.y, box.height, step);
  const cv::Mat whole(image.height(), image.width(), CV_8UC3, const_cast<uint8_t*>(image.pixels().data()));
  cv::Mat part = whole(box);
  if (step > 1) {
    cv::Mat smaller;
    cv::resize(part, smaller, cv::Size((box.width + step - 1) / step, (box.height + step - 1) / step), 0, 0,
               cv::INTER_AREA);
    part = smaller;
  }
  if (const double rest = shrink / step; rest > 1.05) {
    cv::Mat smooth;
    cv::GaussianBlur(part, smooth, cv::Size(5, 5), 0.5 * std::sqrt(rest * rest - 1));
    part = smooth;
  }
  const double by_x = static_cast<double>(part.cols) / box.width, by_y = static_cast<double>(part.rows) / box.height;
  const double c = shrink * std::cos(square.turn_rad), s = shrink * std::sin(square.turn_rad);
  const double middle = 0.5 * size - 0.5;
  const cv::Matx23d part_from_square(by_x * c, -by_x * s, by_x * (square.x - box.x - (c - s) * middle) - 0.5,  //
                                     by_y * s, by_y * c, by_y * (square.y - box.y - (s + c) * middle) - 0.5);
  cv::Mat sampled;
  cv::warpAffine(part, sampled, part_from_square, cv::Size(size, size), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP,
                 cv::BORDER_CONSTANT);
  for (int y = 0; y < size; ++y) {
    const uint8_t* from = sampled.ptr(y);
    float* to = values.data() + static_cast<size_t>(y) * static_cast<size_t>(size) * 3;
    for (int x = 0; x < size; ++x) {
      for (int channel = 0; channel < 3; ++channel) {
        to[3 * x + channel] = static_cast<float>(from[3 * x + 2 - channel]) / 255.0f;
      }
    }
  }
  return values;
}

Image<float> values_in_image(const std::vector<float>& values, int size, const ImageSquare& square, int width,
                             int height, float elsewhere) {
  check(values.size() == static_cast<size_t>(size) * static_cast<size_t>(size), "values_in_image: {} values",
        values.size());
  Image<float> image(width, height, 1, elsewhere);
  const cv::Rect box = box_around(square, width, height);
  if (box.empty()) return image;
  const double grow = size / square.side, middle = 0.5 * size - 0.5;
  const double c = grow * std::cos(square.turn_rad), s = grow * std::sin(square.turn_rad);
  const double dx = box.x + 0.5 - square.x, dy = box.y + 0.5 - square.y;
  const cv::Matx23d square_from_image(c, s, middle + c * dx + s * dy, -s, c, middle - s * dx + c * dy);
  const cv::Mat from(size, size, CV_32F, const_cast<float*>(values.data()));
  cv::Mat to = cv::Mat(height, width, CV_32F, image.pixels().data())(box);
  cv::warpAffine(from, to, square_from_image, box.size(), cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_CONSTANT,
                 cv::Scalar(elsewhere));
  return image;
}

}  // namespace silpose
