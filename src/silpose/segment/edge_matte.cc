#include "silpose/segment/edge_matte.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <vector>

#include "silpose/base/check.h"
#include "silpose/base/parallel.h"
#include "silpose/segment/mask_mat.h"

namespace silpose {
namespace {

// [tuned on rendered clips of recorded motions: dance, jumping, kick, punch]
constexpr double kBand = 0.02;  // of the larger side of the mask's box
// Distance from the edge, px: up to the first a pixel is no sample of the scene, from their sum on a whole one.
// [tuned on rendered clips of recorded motions: dance, jumping, kick, punch]
constexpr float kUnsureRim = 1.5f, kRim = 3;
// The subject's colour at its edge is that of the nearest pixels this deep inside it, averaged over this many: deep at
// first, as the mask that is given may be too wide, and close to the edge the second time. What is thin is not deep.
struct SampleRule {
  float depth;
  int reach;  // pixels on either side
};
// [tuned on rendered clips of recorded motions: dance, jumping, kick, punch]
constexpr std::array<SampleRule, 2> kRounds = {SampleRule{2.5f, 2}, SampleRule{2, 1}};
constexpr float kThinDepth = 1.2f;
constexpr float kFarthest = 4;   // px beyond the band, of a sample
constexpr float kStray = 16;     // grey levels that a pixel may lie off the line between the two sides' colours
constexpr float kContrast = 12;  // grey levels between the two sides' colours at which image and mask count alike
constexpr float kMisfit = 4;     // how much a background that does not fit counts against the image
constexpr float kLeastWeight = 1e-4f, kDarkest = 0.4f, kBrightest = 1.5f;

float square(float x) { return x * x; }

cv::Mat sample_weight(const cv::Mat& distance) {
  cv::Mat weight = (distance - kUnsureRim) / kRim;
  cv::min(cv::max(weight, 0), 1, weight);
  return weight;
}

void average(cv::Mat& sums, int window) {
  cv::boxFilter(sums, sums, CV_32F, {window, window}, {-1, -1}, true, cv::BORDER_CONSTANT);
}

// The colour of the pixels next to each that are `depth` or more inside the subject.
class NearestColour {
 public:
  NearestColour(const cv::Mat& seen, const cv::Mat& inside, float depth, int reach)
      : seen_(seen), is_sample_(inside >= depth), reach_(reach) {
    cv::distanceTransform(is_sample_ == 0, distance_, labels_, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_PIXEL);
    for (int y = 0; y < seen.rows; ++y) {
      for (int x = 0; x < seen.cols; ++x) {
        if (!is_sample_.at<uint8_t>(y, x)) continue;
        const auto label = static_cast<size_t>(labels_.at<int>(y, x));
        if (label >= places_.size()) places_.resize(label + 1);
        places_[label] = {x, y};
      }
    }
  }

  // Whether there is none within `farthest` somewhere in a region [h, w].
  [[nodiscard]] bool misses(const cv::Mat& region, float farthest) const {
    return places_.empty() || cv::countNonZero(region & (distance_ > farthest)) > 0;
  }

  // Absent where there is none within `farthest`.
  [[nodiscard]] std::optional<cv::Vec3f> at(int x, int y, float farthest) const {
    if (places_.empty() || distance_.at<float>(y, x) > farthest) return std::nullopt;
    const cv::Point place = places_[static_cast<size_t>(labels_.at<int>(y, x))];
    cv::Vec3f sum(0, 0, 0);
    float count = 0;
    for (int v = std::max(place.y - reach_, 0); v <= std::min(place.y + reach_, seen_.rows - 1); ++v) {
      for (int u = std::max(place.x - reach_, 0); u <= std::min(place.x + reach_, seen_.cols - 1); ++u) {
        if (!is_sample_.at<uint8_t>(v, u)) continue;
        sum += cv::Vec3f(seen_.at<cv::Vec3b>(v, u));
        ++count;
      }
    }
    return sum / count;
  }

 private:
  cv::Mat seen_, is_sample_, distance_, labels_;
  std::vector<cv::Point> places_;  // of labels
  int reach_;
};

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

// Where a mask's edge may be, and what is around it; the same however often the edge is moved within it.
struct EdgeScene {
  cv::Rect part;         // of the image
  int band;              // px
  cv::Mat seen, behind;  // [h, w, 3] of the part
  cv::Mat known;         // [h, w] of the part; empty: everywhere
  SceneNow now;
};

// Moves the edge of `mask` [h, w], of the part; `sure` [h, w] decreases where the evidence is inconclusive.
void move_edge(const EdgeScene& scene, const SampleRule& rule, cv::Mat& mask, cv::Mat& sure) {
  cv::Mat inside, outside, near_mask, matte;
  cv::distanceTransform(mask, inside, cv::DIST_L2, cv::DIST_MASK_3);
  cv::distanceTransform(mask == 0, outside, cv::DIST_L2, cv::DIST_MASK_3);
  cv::boxFilter(mask, near_mask, CV_32F, {3, 3});
  mask.convertTo(matte, CV_32F, 1.0 / 255);
  const cv::Mat depth = cv::max(inside, outside);
  const NearestColour deep(scene.seen, inside, rule.depth, rule.reach);
  std::optional<NearestColour> thin;  // seldom needed, and not before the mask is about right
  const float farthest = static_cast<float>(scene.band) + kFarthest;
  if (&rule == &kRounds.back() && deep.misses(depth <= scene.band, farthest))
    thin.emplace(scene.seen, inside, kThinDepth, rule.reach);
  parallel_for(static_cast<size_t>(mask.rows), 16, [&](size_t begin, size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < mask.cols; ++x) {
        if (depth.at<float>(y, x) > static_cast<float>(scene.band)) continue;
        if (!scene.known.empty() && !scene.known.at<uint8_t>(y, x)) continue;
        std::optional<cv::Vec3f> of_subject = deep.at(x, y, farthest);
        if (!of_subject && thin) of_subject = thin->at(x, y, farthest);
        if (!of_subject) continue;
        const auto [light, misfit] = scene.now.at(x, y);
        // From the background towards the subject's colour; what lies off that line is another colour of the subject,
        // as far as it is no noise. Noise in the background alone must not count: it would widen the mask.
        float along = 0, away = 0, apart = 0;
        for (int c = 0; c < 3; ++c) {
          const float centre = c == 0 ? 0.0f : 128.0f;
          const float empty = centre + light * (static_cast<float>(scene.behind.at<cv::Vec3b>(y, x)[c]) - centre);
          const float pixel = static_cast<float>(scene.seen.at<cv::Vec3b>(y, x)[c]) - empty;
          const float whole = (*of_subject)[c] - empty;
          along += pixel * whole;
          away += pixel * pixel;
          apart += whole * whole;
        }
        apart = std::max(apart, 1.0f);
        const float towards = along / apart;
        const float off_line = std::max(away - towards * along - kStray * kStray, 0.0f) / apart;
        const float part_covered = std::min(std::sqrt(square(std::max(towards, 0.0f)) + off_line), 1.5f);
        const float say = apart / (apart + kContrast * kContrast + kMisfit * misfit);
        matte.at<float>(y, x) = say * part_covered + (1 - say) * near_mask.at<float>(y, x) / 255;
        const bool agrees = (matte.at<float>(y, x) > 0.5f) == (mask.at<uint8_t>(y, x) != 0);
        const float here = say * std::min(2 * std::abs(part_covered - 0.5f), 1.0f) * (agrees ? 1.0f : 0.5f);
        sure.at<float>(y, x) = std::min(sure.at<float>(y, x), here);
      }
    }
  });
  cv::GaussianBlur(matte, matte, {3, 3}, 0.7);
  mask = matte > 0.5;
}

}  // namespace

EdgeMatte refine_edge(const Mask& mask, const ByteImage& luma_chroma, const ByteImage& background, const Mask* known) {
  const int width = mask.width(), height = mask.height();
  const auto fits = [&](const auto& other) { return other.width() == width && other.height() == height; };
  check(fits(luma_chroma) && fits(background) && (known == nullptr || fits(*known)), "refine_edge: sizes differ");
  EdgeMatte result{mask, ByteImage(width, height, 1, 255)};
  const Box box = mask.bounding_box();
  if (box.empty()) return result;
  const int band = std::max(2, static_cast<int>(std::lround(kBand * std::max(box.width, box.height))));
  const int room = 4 * band + 3, window = 4 * band + 1;
  const cv::Rect part =
      cv::Rect(box.x - room, box.y - room, box.width + 2 * room, box.height + 2 * room) & cv::Rect(0, 0, width, height);
  const auto part_of = [&](const ByteImage& image) {
    return cv::Mat(height, width, CV_8UC3, const_cast<uint8_t*>(image.pixels().data()))(part);
  };
  cv::Mat edge = mat_from_mask(mask)(part).clone(), known_part, outside;
  if (known != nullptr) known_part = mat_from_mask(*known)(part);
  cv::distanceTransform(edge == 0, outside, cv::DIST_L2, cv::DIST_MASK_3);
  cv::Mat of_scene = sample_weight(outside);
  if (known != nullptr) of_scene.setTo(0, known_part == 0);
  const cv::Mat seen = part_of(luma_chroma), behind = part_of(background);
  const EdgeScene scene{part, band, seen, behind, known_part, SceneNow(seen, behind, of_scene, window)};
  cv::Mat sure(part.size(), CV_32F, cv::Scalar(1));
  for (const SampleRule& rule : kRounds) move_edge(scene, rule, edge, sure);
  for (int y = 0; y < part.height; ++y) {
    for (int x = 0; x < part.width; ++x) {
      result.mask.set(part.x + x, part.y + y, edge.at<uint8_t>(y, x) != 0);
      result.confidence.at(part.x + x, part.y + y) = static_cast<uint8_t>(std::lround(255 * sure.at<float>(y, x)));
    }
  }
  return result;
}

}  // namespace silpose
