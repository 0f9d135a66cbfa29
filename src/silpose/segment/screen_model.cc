#include "silpose/segment/screen_model.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "silpose/base/parallel.h"
#include "silpose/segment/mask_mat.h"

namespace silpose {
namespace {

constexpr float kLeastShare = 0.08f;  // [guess] of the image, for a screen

// Deeper shadow than this part of the screen's luma is treated as something black. [tuned on two real clips, with a
// green cloth and a yellow-green wall]
constexpr float kDeepestShadow = 0.2f;
constexpr float kAskedInShadow = 0.7f;
// Hue may deviate this far (as tangent) without loss; beyond, this much of the likeness is lost for each unit.
// [tuned on the same two clips]
constexpr float kHueSlack = 0.35f, kHueLoss = 1.3f;

// [guess]
constexpr int kCell = 8;                                  // pixels; the screen's colour changes slowly
constexpr float kSureLikeness = 0.65f, kSureCell = 0.9f;  // parts: what the model is learned from
constexpr float kLeastSeen = 0.02f;                       // of a neighbourhood, for its colour to be known from there
constexpr float kLeastPart = 0.1f;                        // of the largest piece of screen, for another piece to count
constexpr double kEdgeOfScreen = 0.006;                   // of the image's height: colours mix there
constexpr int kEdgeWindow = 7;                            // pixels [tuned on a rendered dance: 5 or 7]
constexpr double kFlatLuma = 12;                          // grey levels of deviation below which the luma says little

// 1 as the lit screen, 0 as anything neutral or of another hue. `project` as in ScreenModel.
inline float likeness(const LumaChroma& colour, const float* project) {
  const float along = colour.cr * project[1] + colour.cb * project[2];
  const float across = std::abs(colour.cr * project[2] - colour.cb * project[1]);
  const float luma = std::max(colour.luma * project[0], kDeepestShadow);
  // A shadow keeps the screen's saturation: what is dark and has half of it is something else, at a soft edge half is
  // screen.
  const float asked = 1 + kAskedInShadow * std::max(0.0f, 1 - luma);
  return (std::hypot(along, across) - kHueLoss * std::max(0.0f, across - kHueSlack * along)) / (luma * asked);
}

std::array<float, 3> projection(const LumaChroma& screen) {
  const float squared = std::max(screen.cr * screen.cr + screen.cb * screen.cb, 1.0f);
  return {1 / std::max(screen.luma, 1.0f), screen.cr / squared, screen.cb / squared};
}

// [h, w] of mean Y, Cr, Cb and 1, times the part of the samples in which nearly all of a cell is surely screen. Surely:
// edges, spill and deep shadow would draw the model to the subject's colours.
cv::Mat gather_screen(const BackgroundSamples& samples, const Image<float>& project, const std::optional<Mask>& keep) {
  const int width = samples.images[0].width(), height = samples.images[0].height();
  cv::Mat cells((height + kCell - 1) / kCell, (width + kCell - 1) / kCell, CV_32FC4, cv::Scalar::all(0));
  parallel_for(static_cast<size_t>(cells.rows * cells.cols), 64, [&](size_t begin, size_t end) {
    for (int cell = static_cast<int>(begin); cell < static_cast<int>(end); ++cell) {
      const int x0 = cell % cells.cols * kCell, y0 = cell / cells.cols * kCell;
      const int x1 = std::min(x0 + kCell, width), y1 = std::min(y0 + kCell, height);
      cv::Vec4f& all = cells.at<cv::Vec4f>(cell / cells.cols, cell % cells.cols);
      for (const ByteImage& image : samples.images) {
        cv::Vec4f sum(0, 0, 0, 0);
        for (int y = y0; y < y1; ++y) {
          for (int x = x0; x < x1; ++x) {
            const LumaChroma colour = luma_chroma_at(image, x, y);
            if (likeness(colour, &project.at(x, y)) < kSureLikeness) continue;
            if (!keep || keep->get(x, y)) sum += cv::Vec4f(colour.luma, colour.cr, colour.cb, 1);
          }
        }
        const auto area = static_cast<float>((x1 - x0) * (y1 - y0));
        if (sum[3] >= kSureCell * area) all += sum / (sum[3] * static_cast<float>(samples.images.size()));
      }
    }
  });
  return cells;
}

// The screen's colour everywhere: near what was seen of it as there, elsewhere as in a wider and wider neighbourhood.
Image<float> fill_in(const cv::Mat& cells, int width, int height) {
  cv::Mat filled(cells.size(), CV_32FC3, cv::Scalar::all(0)), known(cells.size(), CV_8U, cv::Scalar::all(0));
  for (double sigma = 1.5; cv::countNonZero(known) < known.rows * known.cols && sigma < 4.0 * (cells.rows + cells.cols);
       sigma *= 2) {
    cv::Mat blurred;
    cv::GaussianBlur(cells, blurred, {}, sigma, sigma, cv::BORDER_CONSTANT);
    for (int y = 0; y < cells.rows; ++y) {
      for (int x = 0; x < cells.cols; ++x) {
        const cv::Vec4f& sum = blurred.at<cv::Vec4f>(y, x);
        if (known.at<uint8_t>(y, x) || sum[3] < kLeastSeen) continue;
        const std::array<float, 3> project = projection({sum[0] / sum[3], sum[1] / sum[3], sum[2] / sum[3]});
        filled.at<cv::Vec3f>(y, x) = {project[0], project[1], project[2]};
        known.at<uint8_t>(y, x) = 1;
      }
    }
  }
  // Still unknown: far from all screen. Nothing is like it there.
  Image<float> project(width, height, 3);
  cv::Mat view(height, width, CV_32FC3, project.pixels().data()), large;
  cv::resize(filled, large, {filled.cols * kCell, filled.rows * kCell}, 0, 0, cv::INTER_LINEAR);
  large(cv::Rect(0, 0, width, height)).copyTo(view);
  return project;
}

// Video carries colour at half the resolution, so the matte's edges are wide and lie a pixel off where the luma changes
// as well. Where it does, the matte follows it, as a linear function of it in each small window.
void follow_luma(cv::Mat& matte, const cv::Mat& image) {
  cv::Mat luma, mean_luma, mean_matte, variance, covariance, slope, offset, trust;
  cv::extractChannel(image, luma, 0);
  luma.convertTo(luma, CV_32F);
  const auto average = [](const cv::Mat& from, cv::Mat& to) {
    cv::boxFilter(from, to, CV_32F, {kEdgeWindow, kEdgeWindow}, {-1, -1}, true, cv::BORDER_REPLICATE);
  };
  average(luma, mean_luma);
  average(matte, mean_matte);
  average(luma.mul(luma), variance);
  average(luma.mul(matte), covariance);
  variance -= mean_luma.mul(mean_luma);
  covariance -= mean_luma.mul(mean_matte);
  trust = variance / (variance + kFlatLuma * kFlatLuma);
  slope = covariance / (variance + 1);
  offset = mean_matte - slope.mul(mean_luma);
  average(slope, slope);
  average(offset, offset);
  const cv::Mat followed = slope.mul(luma) + offset;
  cv::Mat(matte + trust.mul(followed - matte)).copyTo(matte);
}

// 1 where an image shows the screen, softly at edges; [H, W].
cv::Mat screen_matte(const Image<float>& project, const ByteImage& luma_chroma) {
  cv::Mat matte(project.height(), project.width(), CV_32F);
  parallel_for(static_cast<size_t>(matte.rows), 16, [&](size_t begin, size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < matte.cols; ++x) {
        const float like = likeness(luma_chroma_at(luma_chroma, x, y), &project.at(x, y));
        matte.at<float>(y, x) = std::clamp(like, 0.0f, 1.0f);
      }
    }
  });
  cv::GaussianBlur(matte, matte, {5, 5}, 1);  // against noise; an edge stays where it is
  return matte;
}

// Sets `inside` and `filled`: the convex hull of the large pieces of what is screen in some of the samples, less its
// very edge.
void find_extent(const BackgroundSamples& samples, ScreenModel& model) {
  const Image<float>& project = model.project;
  constexpr size_t kEnough = 24;  // [guess] samples
  const size_t step = (samples.images.size() + kEnough - 1) / kEnough;
  cv::Mat times(project.height(), project.width(), CV_8U, cv::Scalar::all(0));
  size_t seen = 0;
  for (size_t i = 0; i < samples.images.size(); i += step, ++seen) {
    cv::add(times, 1, times, screen_matte(project, samples.images[i]) >= 0.5);
  }
  cv::Mat ever = times >= (seen > 8 ? 2 : 1);  // once may be noise
  cv::morphologyEx(ever, ever, cv::MORPH_OPEN, cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5}));
  cv::Mat labels, stats, centres;
  const int count = cv::connectedComponentsWithStats(ever, labels, stats, centres, 8, CV_32S);
  int largest = 0;
  for (int label = 1; label < count; ++label) largest = std::max(largest, stats.at<int>(label, cv::CC_STAT_AREA));
  std::vector<cv::Point> corners, hull;
  for (int label = 1; label < count; ++label) {
    if (static_cast<float>(stats.at<int>(label, cv::CC_STAT_AREA)) < kLeastPart * static_cast<float>(largest)) continue;
    std::vector<cv::Point> points;
    cv::findNonZero(labels == label, points);
    corners.insert(corners.end(), points.begin(), points.end());
  }
  cv::Mat inside(ever.size(), CV_8U, cv::Scalar::all(0));
  if (!corners.empty()) {
    cv::convexHull(corners, hull);
    cv::fillConvexPoly(inside, hull, cv::Scalar::all(255));
    const int edge = 2 * static_cast<int>(std::lround(kEdgeOfScreen * ever.rows)) + 1;
    cv::erode(inside, inside, cv::getStructuringElement(cv::MORPH_ELLIPSE, {edge, edge}));
  }
  model.filled = cv::countNonZero(ever & inside) / std::max(1.0, static_cast<double>(cv::countNonZero(inside)));
  model.inside = mask_from_mat(inside);
}

}  // namespace

Result<ScreenModel> learn_screen(const BackgroundSamples& samples, const std::optional<KeyColour>& key,
                                 const std::optional<Mask>& keep) {
  check(!samples.images.empty(), "learn_screen: no samples");
  const int width = samples.images[0].width(), height = samples.images[0].height();
  const Dominant dominant = dominant_colour(samples, key, keep);
  if (dominant.share < kLeastShare) {
    return error("no screen: {} covers {:.1f} % of the image",
                 key ? "the key colour's hue" : "the commonest saturated colour", 100 * dominant.share);
  }
  // From one colour for all of the image to one per place.
  Image<float> project(width, height, 3);
  const std::array<float, 3> everywhere = projection(dominant.mean);
  for (size_t i = 0; i < project.pixels().size(); ++i) project.pixels()[i] = everywhere[i % 3];
  for (int round = 0; round < 2; ++round) project = fill_in(gather_screen(samples, project, keep), width, height);
  ScreenModel model{.key = to_key(dominant.mean), .project = std::move(project)};
  find_extent(samples, model);
  return model;
}

Mask find_before_screen(const ScreenModel& model, const ByteImage& luma_chroma) {
  check(luma_chroma.width() == model.width() && luma_chroma.height() == model.height() && luma_chroma.channels() == 3,
        "find_before_screen: {}x{}, the model {}x{}", luma_chroma.width(), luma_chroma.height(), model.width(),
        model.height());
  cv::Mat matte = screen_matte(model.project, luma_chroma);
  const cv::Mat image(matte.size(), CV_8UC3, const_cast<uint8_t*>(luma_chroma.pixels().data()));
  cv::Mat before = matte < 0.5;
  const cv::Rect all(0, 0, matte.cols, matte.rows);
  cv::Rect around = cv::boundingRect(before & mat_from_mask(model.inside));
  if (!around.empty()) {
    around = cv::Rect(around.x - kEdgeWindow, around.y - kEdgeWindow, around.width + 2 * kEdgeWindow,
                      around.height + 2 * kEdgeWindow) &
             all;
    cv::Mat part = matte(around);
    follow_luma(part, image(around));
    before = matte < 0.5;
  }
  return mask_from_mat(before);
}

}  // namespace silpose
