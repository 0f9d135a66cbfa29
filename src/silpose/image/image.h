// Image<T>: an image in memory, row-major, channels interleaved. Colour images are 8-bit B, G, R (OpenCV's order).
// Threads: a value.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "silpose/base/check.h"

namespace silpose {

template <class T>
class Image {
 public:
  Image() = default;
  Image(int width, int height, int channels = 1, T fill = T{}) : width_(width), height_(height), channels_(channels) {
    check(width >= 0 && height >= 0 && channels >= 1, "Image: size {}x{}x{}", width, height, channels);
    data_.assign(static_cast<size_t>(width) * static_cast<size_t>(height) * static_cast<size_t>(channels), fill);
  }

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] int channels() const { return channels_; }
  [[nodiscard]] bool empty() const { return data_.empty(); }

  // REQUIRES: inside the image.
  T& at(int x, int y, int channel = 0) { return data_[offset(x, y, channel)]; }
  const T& at(int x, int y, int channel = 0) const { return data_[offset(x, y, channel)]; }

  std::span<T> row(int y) { return std::span<T>(data_).subspan(offset(0, y, 0), row_size()); }
  std::span<const T> row(int y) const { return std::span<const T>(data_).subspan(offset(0, y, 0), row_size()); }
  std::span<T> pixels() { return data_; }
  std::span<const T> pixels() const { return data_; }

  bool operator==(const Image&) const = default;

 private:
  [[nodiscard]] size_t row_size() const { return static_cast<size_t>(width_) * static_cast<size_t>(channels_); }
  [[nodiscard]] size_t offset(int x, int y, int channel) const {
    return static_cast<size_t>(y) * row_size() + static_cast<size_t>(x) * static_cast<size_t>(channels_) +
           static_cast<size_t>(channel);
  }
  int width_ = 0, height_ = 0, channels_ = 1;
  std::vector<T> data_;
};

using ByteImage = Image<uint8_t>;
using DepthImage = Image<uint16_t>;  // [H, W] millimetres along the viewing axis; 0: not measured

}  // namespace silpose
