#include "silpose/segment/mask_confidence.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "silpose/base/check.h"

namespace silpose {
namespace {

constexpr uint8_t kChanged = 64;      // [guess] of 255
constexpr double kSharpEdge = 0.005;  // [guess] of the larger side of the mask's box, on either side

}  // namespace

void lower_confidence(ByteImage& confidence, const ByteImage& other) {
  check(confidence.width() == other.width() && confidence.height() == other.height(), "lower_confidence: sizes differ");
  const auto to = confidence.pixels();
  const auto from = other.pixels();
  for (size_t i = 0; i < to.size(); ++i) to[i] = std::min(to[i], from[i]);
}

void doubt_changes(ByteImage& confidence, const Mask& found, const Mask& cleaned) {
  for (int y = 0; y < cleaned.height(); ++y) {
    const auto before = found.row(y), after = cleaned.row(y);
    const auto to = confidence.row(y);
    for (size_t word = 0; word < after.size(); ++word) {
      for (uint64_t changed = before[word] ^ after[word]; changed != 0; changed &= changed - 1) {
        uint8_t& value = to[64 * word + static_cast<size_t>(std::countr_zero(changed))];
        value = std::min(value, kChanged);
      }
    }
  }
}

void forgive_edges(ByteImage& confidence, const Mask& mask) {
  const Box box = mask.bounding_box();
  const int radius = std::max(1, static_cast<int>(std::lround(kSharpEdge * std::max(box.width, box.height))));
  const cv::Mat view(confidence.height(), confidence.width(), CV_8U, confidence.pixels().data());
  // Stripes only: what is left after growing is shrunk back to its old size.
  cv::morphologyEx(view, view, cv::MORPH_CLOSE,
                   cv::getStructuringElement(cv::MORPH_RECT, {2 * radius + 1, 2 * radius + 1}));
}

}  // namespace silpose
