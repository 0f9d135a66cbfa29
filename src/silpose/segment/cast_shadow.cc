#include "silpose/segment/cast_shadow.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "silpose/base/check.h"

namespace silpose {
namespace {

// [tuned on rendered clips of recorded motions: dance, jumping, kick, punch]
constexpr float kDarkest = 0.4f, kLightest = 0.95f;  // factors of the background's luma that a shadow may have
// Tint: how far the chroma is from the background's, scaled as the luma is, in deviations of noise. On the floor, at
// the height of the feet, where shadows are to be expected, more passes for shadow; from kNoShadow on nothing.
// [tuned on rendered clips of recorded motions: dance, jumping, kick, punch]
constexpr float kTint = 1.6f, kTintOnFloor = 3.2f, kNoShadow = 4;
constexpr float kBrightest = 1.2f;
constexpr float kFloorFrom = 0.75f;     // of the subject's height, from the top
constexpr float kFlat = 0.05f;          // deviation of the factor within a shadow
constexpr float kSameFactor = 0.06f;    // from the factor that most of the shadow has
constexpr float kDeeper = 0.1f;         // below the tenth part of its deepest factors: no shadow of this light
constexpr size_t kLeastCore = 30;       // pixels
constexpr int kSpread = 7;              // pixels, from where it is certain to where it could be
constexpr int kSolid = 5, kMargin = 8;  // pixels: what is less wide may be noise
constexpr int kEnoughPixels = 360;      // of the image's smaller side; larger ones are reduced for speed
constexpr int kLeastOfRow = 3;          // pixels that make a row the subject's

// An image compared with its background, within `part` of it.
struct Comparison {
  cv::Mat factor;  // [h, w] of the luma, which noise and coding affect less over 3x3 pixels
  cv::Mat tint;    // [h, w]
  cv::Mat spread;  // [h, w] squared deviation of the factor around
};

cv::Mat mat_of(const ByteImage& image, int type) {
  return {image.height(), image.width(), type, const_cast<uint8_t*>(image.pixels().data())};
}

Comparison compare(const BackgroundModel& model, const ByteImage& luma_chroma, float gain, const cv::Rect& part) {
  const cv::Mat now = mat_of(luma_chroma, CV_8UC3)(part), then = mat_of(model.median, CV_8UC3)(part);
  Comparison result;
  cv::Mat luma, empty;
  cv::extractChannel(now, luma, 0);
  cv::extractChannel(then, empty, 0);
  luma.convertTo(luma, CV_32F);
  empty.convertTo(empty, CV_32F, gain);
  cv::blur(luma, luma, {3, 3});
  cv::blur(empty, empty, {3, 3});
  result.factor = luma / cv::max(empty, 1.0f);
  cv::Mat chroma(part.size(), CV_32FC2);
  for (int y = 0; y < part.height; ++y) {
    const auto *n = now.ptr<cv::Vec3b>(y), *t = then.ptr<cv::Vec3b>(y);
    const auto* f = result.factor.ptr<float>(y);
    auto* to = chroma.ptr<cv::Vec2f>(y);
    for (int x = 0; x < part.width; ++x) {
      for (int c = 0; c < 2; ++c) {
        const float expected = gain * f[x] * (static_cast<float>(t[x][c + 1]) - 128);
        to[x][c] = static_cast<float>(n[x][c + 1]) - 128 - expected;
      }
    }
  }
  cv::blur(chroma, chroma, {5, 5});
  result.tint.create(part.size(), CV_32F);
  for (int y = 0; y < part.height; ++y) {
    for (int x = 0; x < part.width; ++x) {
      const auto& off = chroma.at<cv::Vec2f>(y, x);
      const float* noise = &model.noise.at(part.x + x, part.y + y);
      const float cr = off[0] / noise[1], cb = off[1] / noise[2];
      result.tint.at<float>(y, x) = std::sqrt(cr * cr + cb * cb);
    }
  }
  cv::Mat mean;
  cv::blur(result.factor, mean, {5, 5});
  cv::blur(result.factor.mul(result.factor), result.spread, {5, 5});
  result.spread -= mean.mul(mean);
  return result;
}

// The row of `part` from which on the floor's tolerance counts, by the rows of what cannot be shadow.
int floor_row(const Comparison& compared, const cv::Mat& differs) {
  int top = differs.rows, bottom = 0;
  for (int y = 0; y < differs.rows; ++y) {
    int count = 0;
    for (int x = 0; x < differs.cols; ++x) {
      const float factor = compared.factor.at<float>(y, x);
      const bool is_subject = factor < kDarkest || factor > kBrightest || compared.tint.at<float>(y, x) > kNoShadow;
      count += differs.at<uint8_t>(y, x) != 0 && is_subject ? 1 : 0;
    }
    if (count < kLeastOfRow) continue;
    top = std::min(top, y);
    bottom = y;
  }
  return std::min(top + static_cast<int>(kFloorFrom * static_cast<float>(std::max(bottom - top, 0))), differs.rows);
}

float quantile(std::vector<float>& values, size_t divisor) {
  const auto at = values.begin() + static_cast<ptrdiff_t>(values.size() / divisor);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// To another size.
ByteImage resized(const ByteImage& image, int type, const cv::Size& size, int interpolation) {
  ByteImage small(size.width, size.height, image.channels());
  cv::Mat to = mat_of(small, type);
  cv::resize(mat_of(image, type), to, size, 0, 0, interpolation);
  return small;
}

CastShadow find_at_size(const BackgroundModel& model, const ByteImage& luma_chroma, float gain,
                        const ByteImage& differs) {
  const int width = model.width(), height = model.height();
  CastShadow result{.shadow = ByteImage(width, height), .looks_like = ByteImage(width, height), .floor_row = height};
  // Around what is more than noise.
  cv::Mat changed = mat_of(differs, CV_8U), solid;
  cv::erode(changed, solid, cv::getStructuringElement(cv::MORPH_RECT, {kSolid, kSolid}));
  const cv::Rect box = cv::boundingRect(solid);
  if (box.empty()) return result;
  const int margin = kMargin + std::max(box.width, box.height) / 8;
  const cv::Rect part = cv::Rect(box.x - margin, box.y - margin, box.width + 2 * margin, box.height + 2 * margin) &
                        cv::Rect(0, 0, width, height);
  changed = changed(part) != 0;
  const Comparison compared = compare(model, luma_chroma, gain, part);
  const int floor = floor_row(compared, changed);
  result.floor_row = part.y + floor;

  cv::Mat could_be = (compared.factor >= kDarkest) & (compared.factor <= kLightest) & (compared.tint <= kTintOnFloor);
  could_be.rowRange(0, floor).setTo(0, compared.tint.rowRange(0, floor) > kTint);
  cv::Mat core = could_be & changed & (compared.spread < kFlat * kFlat);
  std::vector<float> factors;
  for (int y = 0; y < part.height; ++y) {
    for (int x = 0; x < part.width; ++x) {
      if (core.at<uint8_t>(y, x) != 0) factors.push_back(compared.factor.at<float>(y, x));
    }
  }
  if (factors.size() < kLeastCore) return result;
  const float usual = quantile(factors, 2), deepest = quantile(factors, 10) - kDeeper;
  core |= could_be & changed & (compared.factor > usual - kSameFactor) & (compared.factor < usual + kSameFactor);
  could_be &= compared.factor >= deepest;
  could_be &= changed;
  core &= could_be;
  const cv::Rect near = cv::boundingRect(core);
  const cv::Rect within =
      cv::Rect(near.x - kSpread, near.y - kSpread, near.width + 2 * kSpread, near.height + 2 * kSpread) &
      cv::Rect(0, 0, part.width, part.height);
  cv::Mat shadow = core(within);
  const cv::Mat neighbours = cv::getStructuringElement(cv::MORPH_RECT, {3, 3});
  for (int step = 0; step < kSpread; ++step) {
    cv::dilate(shadow, shadow, neighbours);
    shadow &= could_be(within);
  }
  core.copyTo(mat_of(result.shadow, CV_8U)(part));
  could_be.rowRange(0, floor).setTo(0);
  could_be.copyTo(mat_of(result.looks_like, CV_8U)(part));
  return result;
}

}  // namespace

CastShadow find_cast_shadow(const BackgroundModel& model, const ByteImage& luma_chroma, float gain,
                            const ByteImage& differs) {
  const int width = model.width(), height = model.height();
  check(luma_chroma.width() == width && luma_chroma.height() == height && differs.width() == width &&
            differs.height() == height,
        "find_cast_shadow: sizes differ");
  const int scale = std::min(width, height) / kEnoughPixels;
  if (scale <= 1) return find_at_size(model, luma_chroma, gain, differs);
  const cv::Size size(width / scale, height / scale);
  BackgroundModel small{.median = resized(model.median, CV_8UC3, size, cv::INTER_AREA),
                        .noise = Image<float>(size.width, size.height, 3)};
  cv::Mat noise(size, CV_32FC3, small.noise.pixels().data());
  cv::resize(cv::Mat(height, width, CV_32FC3, const_cast<float*>(model.noise.pixels().data())), noise, size, 0, 0,
             cv::INTER_NEAREST);
  const ByteImage any = resized(differs, CV_8U, size, cv::INTER_NEAREST);
  CastShadow found = find_at_size(small, resized(luma_chroma, CV_8UC3, size, cv::INTER_AREA), gain, any);
  for (ByteImage* image : {&found.shadow, &found.looks_like}) {
    *image = resized(*image, CV_8U, {width, height}, cv::INTER_NEAREST);
    cv::Mat whole = mat_of(*image, CV_8U);
    whole.setTo(0, mat_of(differs, CV_8U) == 0);
  }
  found.floor_row = found.floor_row * height / size.height;
  return found;
}

}  // namespace silpose
