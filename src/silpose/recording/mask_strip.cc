#include "silpose/recording/mask_strip.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "silpose/base/check.h"
#include "silpose/image/image_file.h"
#include "silpose/render/draw_overlay.h"

namespace silpose {
namespace {

constexpr double kRoom = 1.3;   // side of the cut-out over the larger side of the mask
constexpr int kLeastSide = 64;  // pixels: less shows nothing of the surroundings
constexpr int kQuality = 80;

// A square around the mask as far as the image goes; the whole image where there is no mask.
cv::Rect cut_out(const Mask& mask) {
  const Box box = mask.bounding_box();
  if (box.empty()) return {0, 0, mask.width(), mask.height()};
  const int side = std::max(kLeastSide, static_cast<int>(std::lround(kRoom * std::max(box.width, box.height))));
  const int width = std::min(side, mask.width()), height = std::min(side, mask.height());
  return {std::clamp(box.x + (box.width - width) / 2, 0, mask.width() - width),
          std::clamp(box.y + (box.height - height) / 2, 0, mask.height() - height), width, height};
}

ByteImage resized(const ByteImage& image, const cv::Rect& part, cv::Size size) {
  ByteImage result(size.width, size.height, image.channels());
  const int type = CV_8UC(image.channels());
  const cv::Mat from(image.height(), image.width(), type, const_cast<uint8_t*>(image.pixels().data()));
  cv::Mat to(size.height, size.width, type, result.pixels().data());
  cv::resize(from(part), to, size, 0, 0, size.width < part.width ? cv::INTER_AREA : cv::INTER_LINEAR);
  return result;
}

MaskExample example_of(const ByteImage& image, const Mask& mask) {
  const cv::Rect part = cut_out(mask);
  const double scale = static_cast<double>(MaskStrip::kLongestSide) / std::max(part.width, part.height);
  const cv::Size size(std::max(1, static_cast<int>(std::lround(part.width * scale))),
                      std::max(1, static_cast<int>(std::lround(part.height * scale))));
  ByteImage small = resized(image, part, size);
  draw_outline(small, mask_from_image(resized(image_from_mask(mask), part, size)));
  return {
      .width = size.width, .height = size.height, .is_empty = mask.count() == 0, .jpeg = jpeg_bytes(small, kQuality)};
}

}  // namespace

void MaskStrip::add(int64_t frame_idx, double time_s, const ByteImage& image, const Mask& mask) {
  check(image.width() == mask.width() && image.height() == mask.height() && !image.empty(),
        "MaskStrip: mask of {}x{} on an image of {}x{}", mask.width(), mask.height(), image.width(), image.height());
  if (num_seen_++ % stride_ != 0) return;
  MaskExample example = example_of(image, mask);
  example.frame_idx = frame_idx;
  example.time_s = time_s;
  kept_.push_back(std::move(example));
  if (kept_.size() < 4 * kMost) return;
  for (size_t i = 1; i < 2 * kMost; ++i) kept_[i] = std::move(kept_[2 * i]);
  kept_.resize(2 * kMost);
  stride_ *= 2;
}

std::vector<MaskExample> MaskStrip::examples() const {
  if (kept_.size() <= kMost) return kept_;
  std::vector<MaskExample> chosen;
  for (size_t i = 0; i < kMost; ++i) chosen.push_back(kept_[(i * (kept_.size() - 1) + (kMost - 1) / 2) / (kMost - 1)]);
  return chosen;
}

}  // namespace silpose
