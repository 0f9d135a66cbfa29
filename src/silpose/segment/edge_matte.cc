#include "silpose/segment/edge_matte.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "silpose/base/check.h"
#include "silpose/base/parallel.h"
#include "silpose/segment/mask_mat.h"

namespace silpose {
namespace {

constexpr double kBand = 0.02;  // of the larger side of the mask's box
// Distance from the edge, px: up to the first a pixel is no sample of its side, from their sum on a whole one.
constexpr float kUnsureRim = 1.5f, kRim = 3;
constexpr float kContrast = 12;  // grey levels between the two sides' colours at which picture and mask count alike
constexpr float kMisfit = 4;     // how much a background that does not fit counts against the picture
constexpr float kLeastWeight = 1e-4f, kDarkest = 0.4f, kBrightest = 1.5f;

cv::Mat sample_weight(const cv::Mat& distance) {
  cv::Mat weight = (distance - kUnsureRim) / kRim;
  cv::min(cv::max(weight, 0), 1, weight);
  return weight;
}

void average(cv::Mat& sums, int window) {
  cv::boxFilter(sums, sums, CV_32F, {window, window}, {-1, -1}, true, cv::BORDER_CONSTANT);
}

// Around each pixel the mean of weight * colour, and of weight as the fourth channel.
cv::Mat local_mean(const cv::Mat& colours, const cv::Mat& weight, int window) {
  cv::Mat sums(colours.size(), CV_32FC4);
  for (int y = 0; y < colours.rows; ++y) {
    const auto* c = colours.ptr<cv::Vec3b>(y);
    const auto* w = weight.ptr<float>(y);
    auto* to = sums.ptr<cv::Vec4f>(y);
    for (int x = 0; x < colours.cols; ++x) {
      const auto luma = static_cast<float>(c[x][0]), cr = static_cast<float>(c[x][1]), cb = static_cast<float>(c[x][2]);
      to[x] = {w[x] * luma, w[x] * cr, w[x] * cb, w[x]};
    }
  }
  average(sums, window);
  return sums;
}

// How the scene around each pixel, as far as it is seen now, compares with the background.
struct SceneNow {
  cv::Mat seen;    // [h, w, 4] means of weight * (luma, luma^2, luma * background), and of the weight
  cv::Mat behind;  // [h, w, 2] means of weight * (background, background^2)

  SceneNow(const cv::Mat& now, const cv::Mat& background, const cv::Mat& weight, int window)
      : seen(now.size(), CV_32FC4), behind(now.size(), CV_32FC2) {
    for (int y = 0; y < now.rows; ++y) {
      const auto *n = now.ptr<cv::Vec3b>(y), *b = background.ptr<cv::Vec3b>(y);
      const auto* w = weight.ptr<float>(y);
      for (int x = 0; x < now.cols; ++x) {
        const auto here = static_cast<float>(n[x][0]), empty = static_cast<float>(b[x][0]);
        seen.at<cv::Vec4f>(y, x) = {w[x] * here, w[x] * here * here, w[x] * here * empty, w[x]};
        behind.at<cv::Vec2f>(y, x) = {w[x] * empty, w[x] * empty * empty};
      }
    }
    average(seen, window);
    average(behind, window);
  }

  struct Light {
    float factor = 1;  // by which the background is lit now, in a shadow for instance
    float misfit = 0;  // mean squared luma that it leaves over
  };
  [[nodiscard]] Light at(int x, int y) const {
    const auto& now = seen.at<cv::Vec4f>(y, x);
    const auto& then = behind.at<cv::Vec2f>(y, x);
    if (now[3] < kLeastWeight) return {};
    const float factor = std::clamp(now[0] / std::max(then[0], kLeastWeight), kDarkest, kBrightest);
    const float left = now[1] - 2 * factor * now[2] + factor * factor * then[1];
    return {factor, std::max(left / now[3], 0.0f)};
  }
};

}  // namespace

EdgeMatte refine_edge(const Mask& mask, const ByteImage& luma_chroma, const ByteImage& background, const Mask* known) {
  const int width = mask.width(), height = mask.height();
  const auto fits = [&](const auto& other) { return other.width() == width && other.height() == height; };
  check(fits(luma_chroma) && fits(background) && (known == nullptr || fits(*known)), "refine_edge: sizes differ");
  EdgeMatte result{mask, ByteImage(width, height, 1, 255)};
  const Box box = mask.bounding_box();
  if (box.empty()) return result;
  const int band = std::max(2, static_cast<int>(std::lround(kBand * std::max(box.width, box.height))));
  const int room = 3 * band + 3, window = 4 * band + 1;
  const int x0 = std::max(box.x - room, 0), y0 = std::max(box.y - room, 0);
  const cv::Rect part(x0, y0, std::min(box.x + box.width + room, width) - x0,
                      std::min(box.y + box.height + room, height) - y0);
  const auto part_of = [&](const ByteImage& image) {
    return cv::Mat(height, width, CV_8UC3, const_cast<uint8_t*>(image.pixels().data()))(part);
  };
  const cv::Mat seen = part_of(luma_chroma), behind = part_of(background), before = mat_from_mask(mask)(part);
  cv::Mat inside, outside, near_mask;
  cv::distanceTransform(before, inside, cv::DIST_L2, cv::DIST_MASK_3);
  cv::distanceTransform(before == 0, outside, cv::DIST_L2, cv::DIST_MASK_3);
  cv::boxFilter(before, near_mask, CV_32F, {3, 3});
  cv::Mat of_scene = sample_weight(outside);
  if (known != nullptr) of_scene.setTo(0, mat_from_mask(*known)(part) == 0);
  const cv::Mat subject = local_mean(seen, sample_weight(inside), window);
  const SceneNow scene(seen, behind, of_scene, window);

  cv::Mat matte(part.size(), CV_32F), sure(part.size(), CV_32F, cv::Scalar(1));
  before.convertTo(matte, CV_32F, 1.0 / 255);
  parallel_for(static_cast<size_t>(part.height), 16, [&](size_t begin, size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < part.width; ++x) {
        const float depth = std::max(inside.at<float>(y, x), outside.at<float>(y, x));
        if (depth > static_cast<float>(band)) continue;
        if (known != nullptr && !known->get(part.x + x, part.y + y)) continue;
        const auto& of_subject = subject.at<cv::Vec4f>(y, x);
        if (of_subject[3] < kLeastWeight) continue;
        const auto [light, misfit] = scene.at(x, y);
        float away = 0, apart = 0;  // squared: of the pixel from the background, of the subject from it
        for (int c = 0; c < 3; ++c) {
          const float centre = c == 0 ? 0.0f : 128.0f;
          const float empty = centre + light * (static_cast<float>(behind.at<cv::Vec3b>(y, x)[c]) - centre);
          const float pixel = static_cast<float>(seen.at<cv::Vec3b>(y, x)[c]) - empty;
          const float whole = of_subject[c] / of_subject[3] - empty;
          away += pixel * pixel;
          apart += whole * whole;
        }
        const float part_covered = std::min(std::sqrt(away / std::max(apart, 1.0f)), 1.5f);
        const float say = apart / (apart + kContrast * kContrast + kMisfit * misfit);
        matte.at<float>(y, x) = say * part_covered + (1 - say) * near_mask.at<float>(y, x) / 255;
        const bool agrees = (matte.at<float>(y, x) > 0.5f) == (before.at<uint8_t>(y, x) != 0);
        sure.at<float>(y, x) = say * std::min(2 * std::abs(part_covered - 0.5f), 1.0f) * (agrees ? 1.0f : 0.5f);
      }
    }
  });
  cv::GaussianBlur(matte, matte, {3, 3}, 0.7);
  for (int y = 0; y < part.height; ++y) {
    for (int x = 0; x < part.width; ++x) {
      result.mask.set(part.x + x, part.y + y, matte.at<float>(y, x) > 0.5f);
      result.confidence.at(part.x + x, part.y + y) = static_cast<uint8_t>(std::lround(255 * sure.at<float>(y, x)));
    }
  }
  return result;
}

}  // namespace silpose
