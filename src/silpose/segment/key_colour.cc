#include "silpose/segment/key_colour.h"

#include <algorithm>
#include <numbers>
#include <opencv2/imgproc.hpp>

namespace silpose {
namespace {

// [guess] A colour that may be a screen's: chroma in grey levels, and as a part of luma (which is not trusted below a
// floor).
constexpr float kLeastChroma = 12, kLeastSaturation = 0.33f, kDarkLuma = 40;
constexpr float kHueWindowDeg = 20;  // [tuned on two real clips, with a green cloth and a yellow-green wall]
// [guess] Hues (atan2 of Cb, Cr) from red to orange are skin's and wood's: not a screen's unless the user says so.
constexpr float kSkinFromDeg = -75, kSkinToDeg = 20;

constexpr float kDegree = std::numbers::pi_v<float> / 180;  // [definition]

LumaChroma to_colour(const KeyColour& key) {
  ByteImage pixel(1, 1, 3);
  for (int c = 0; c < 3; ++c) pixel.at(0, 0, c) = key[static_cast<size_t>(2 - c)];
  return luma_chroma_at(to_luma_chroma(pixel), 0, 0);
}

bool is_saturated(const LumaChroma& colour) {
  return colour.chroma() > kLeastChroma && colour.chroma() > kLeastSaturation * std::max(colour.luma, kDarkLuma);
}

}  // namespace

Result<std::optional<KeyColour>> parse_key_colour(const std::string& text) {
  if (text == "auto") return std::optional<KeyColour>();
  const bool is_hex =
      text.size() == 7 && text[0] == '#' && text.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
  if (!is_hex) return error("key colour '{}': auto, or #rrggbb", text);
  KeyColour key{};
  for (size_t i = 0; i < 3; ++i) key[i] = static_cast<uint8_t>(std::stoi(text.substr(1 + 2 * i, 2), nullptr, 16));
  if (to_colour(key).chroma() < kLeastChroma) return error("key colour '{}': a grey has no hue to key by", text);
  return std::optional(key);
}

KeyColour to_key(const LumaChroma& colour) {
  const cv::Mat pixel(1, 1, CV_8UC3,
                      cv::Scalar(std::round(colour.luma), std::round(colour.cr) + 128, std::round(colour.cb) + 128));
  cv::Mat rgb;
  cv::cvtColor(pixel, rgb, cv::COLOR_YCrCb2RGB);
  const auto& p = rgb.at<cv::Vec3b>(0, 0);
  return {p[0], p[1], p[2]};
}

Dominant dominant_colour(const BackgroundSamples& samples, const std::optional<KeyColour>& key,
                         const std::optional<Mask>& keep) {
  // [guess]
  constexpr int kBins = 72, kStep = 4, kDegreesPerBin = 360 / kBins,
                kReach = static_cast<int>(kHueWindowDeg) / kDegreesPerBin;
  struct Bin {
    double weight = 0, luma = 0, cr = 0, cb = 0;
  };
  std::array<Bin, kBins> bins{};
  double total = 0;
  const int width = samples.images[0].width(), height = samples.images[0].height();
  const int border = std::min(width, height) / 10;
  for (const ByteImage& image : samples.images) {
    for (int y = kStep / 2; y < height; y += kStep) {
      for (int x = kStep / 2; x < width; x += kStep) {
        if (keep && !keep->get(x, y)) continue;
        const bool at_border = x < border || y < border || x >= width - border || y >= height - border;
        const double weight = at_border && !key ? 2 : 1;
        total += weight;
        const LumaChroma colour = luma_chroma_at(image, x, y);
        if (!is_saturated(colour)) continue;
        const float degrees = std::atan2(colour.cb, colour.cr) / kDegree + 180;
        Bin& bin = bins[static_cast<size_t>(degrees / kDegreesPerBin) % kBins];
        bin.weight += weight;
        bin.luma += weight * static_cast<double>(colour.luma);
        bin.cr += weight * static_cast<double>(colour.cr);
        bin.cb += weight * static_cast<double>(colour.cb);
      }
    }
  }
  const auto around = [&](int centre) {
    Bin sum;
    for (int i = centre - kReach; i <= centre + kReach; ++i) {
      const Bin& bin = bins[static_cast<size_t>((i + kBins) % kBins)];
      sum.weight += bin.weight, sum.luma += bin.luma, sum.cr += bin.cr, sum.cb += bin.cb;
    }
    return sum;
  };
  Bin best;
  if (key) {
    const LumaChroma colour = to_colour(*key);
    best = around(static_cast<int>((std::atan2(colour.cb, colour.cr) / kDegree + 180) / kDegreesPerBin));
  } else {
    for (int i = 0; i < kBins; ++i) {
      const Bin candidate = around(i);
      const double hue = std::atan2(candidate.cb, candidate.cr) / kDegree;
      const bool is_skin = hue > kSkinFromDeg && hue < kSkinToDeg;
      if (!is_skin && candidate.weight > best.weight) best = candidate;
    }
  }
  if (best.weight == 0) return {};
  const auto mean = [&](double sum) { return static_cast<float>(sum / best.weight); };
  return {{mean(best.luma), mean(best.cr), mean(best.cb)}, static_cast<float>(best.weight / std::max(total, 1.0))};
}

}  // namespace silpose
