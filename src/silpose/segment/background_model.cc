#include "silpose/segment/background_model.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "silpose/base/parallel.h"

namespace silpose {
namespace {

// Grey levels. Compressed video repeats blocks of an empty scene unchanged, so a deviation of 0 over time does not mean
// no noise: where a person moves, blocks are coded again, and edges of the scene differ a little. [tuned on rendered
// clips: dance, jumping]
constexpr std::array<float, 3> kNoiseFloor = {3.5f, 2.0f, 2.0f};
constexpr double kNoiseOfSlope = 0.2, kPlateNoiseOfSlope = 0.4;
// A plate is encoded and exposed by itself. [guess]
constexpr std::array<float, 3> kPlateFloor = {3.0f, 1.8f, 1.8f};
constexpr float kMadToDeviation = 1.4826f;  // [definition] of a normal distribution
// Where the subject is in nearly half of the samples the median deviation is the subject's: the lower third of the
// deviations bounds it, loosely, as grey levels are coarse for so small a quantile. kLowerThirdToDeviation is a
// [definition] for a normal distribution, the margin in grey levels a [guess].
constexpr float kLowerThirdToDeviation = 2.32f, kLowerThirdMargin = 1.0f;

// [guess] How many images are kept: enough for a median, bounded in memory.
constexpr int64_t kMaxSamples = 75, kMinSamples = 25;
constexpr int64_t kSampleBytes = int64_t{256} << 20;

int64_t max_samples(const Video& video) {
  const int64_t bytes = int64_t{3} * video.width() * video.height();
  return std::clamp(kSampleBytes / std::max<int64_t>(bytes, 1), kMinSamples, kMaxSamples);
}

// What a few byte values look like: counted, which for values as close together as these beats sorting.
class ByteCounts {
 public:
  void add(uint8_t value) {
    ++fine_[value];
    ++coarse_[value >> 4];
    ++total_;
  }
  void clear() { *this = ByteCounts(); }

  [[nodiscard]] int median() const {
    const int wanted = total_ / 2 + 1;
    int seen = 0, value = 0;
    while (seen + coarse_[static_cast<size_t>(value >> 4)] < wanted) {
      seen += coarse_[static_cast<size_t>(value >> 4)];
      value += 16;
    }
    while ((seen += fine_[static_cast<size_t>(value)]) < wanted) ++value;
    return value;
  }

  // The deviation from `centre` that more than total / divisor values keep to.
  [[nodiscard]] int deviation(int centre, int divisor) const {
    const int wanted = total_ / divisor + 1;
    int seen = fine_[static_cast<size_t>(centre)], reach = 0;
    while (seen < wanted) {
      ++reach;
      if (centre >= reach) seen += fine_[static_cast<size_t>(centre - reach)];
      if (centre + reach < 256) seen += fine_[static_cast<size_t>(centre + reach)];
    }
    return reach;
  }

 private:
  std::array<uint8_t, 256> fine_{};
  std::array<uint8_t, 16> coarse_{};
  int total_ = 0;
};
static_assert(kMaxSamples < 256);

// [H, W, 3] Per pixel and channel, the median over the samples and the median absolute deviation from it.
void median_and_deviation(const std::vector<ByteImage>& images, ByteImage& median, Image<float>& noise) {
  const size_t row_size = images[0].row(0).size();
  parallel_for(static_cast<size_t>(images[0].height()), 8, [&](size_t begin, size_t end) {
    ByteCounts counts;
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      std::vector<const uint8_t*> rows;
      rows.reserve(images.size());
      for (const ByteImage& image : images) rows.push_back(image.row(y).data());
      const auto median_row = median.row(y);
      const auto noise_row = noise.row(y);
      for (size_t i = 0; i < row_size; ++i) {
        counts.clear();
        for (const uint8_t* row : rows) counts.add(row[i]);
        const int centre = counts.median();
        median_row[i] = static_cast<uint8_t>(centre);
        noise_row[i] =
            std::min(kMadToDeviation * static_cast<float>(counts.deviation(centre, 2)),
                     kLowerThirdToDeviation * static_cast<float>(counts.deviation(centre, 3)) + kLowerThirdMargin);
      }
    }
  });
}

// Noise is similar in neighbouring pixels, and one pixel's deviation over few samples is uncertain: average it with
// those around it, and keep to the floor.
void steady_noise(Image<float>& noise, const std::array<float, 3>& floor) {
  cv::Mat view(noise.height(), noise.width(), CV_32FC3, noise.pixels().data());
  cv::Mat around;
  cv::blur(view, around, cv::Size(3, 3));
  view = cv::max(view * 0.5 + around * 0.5, cv::Scalar(floor[0], floor[1], floor[2]));
}

ByteImage convert(const ByteImage& image, int conversion) {
  check(image.channels() == 3, "background: an image of {} channels", image.channels());
  ByteImage converted(image.width(), image.height(), 3);
  cv::Mat to(image.height(), image.width(), CV_8UC3, converted.pixels().data());
  cv::cvtColor(cv::Mat(image.height(), image.width(), CV_8UC3, const_cast<uint8_t*>(image.pixels().data())), to,
               conversion);
  return converted;
}

// `share` of what the image changes from pixel to pixel: that much of a shift is treated as noise.
cv::Mat slope_of(const ByteImage& image, double share) {
  const cv::Mat view(image.height(), image.width(), CV_8UC3, const_cast<uint8_t*>(image.pixels().data()));
  cv::Mat slope_x, slope_y;
  cv::Sobel(view, slope_x, CV_32F, 1, 0, 3, 1.0 / 8);
  cv::Sobel(view, slope_y, CV_32F, 0, 1, 3, 1.0 / 8);
  return share * (cv::abs(slope_x) + cv::abs(slope_y));
}

}  // namespace

ByteImage to_luma_chroma(const ByteImage& image) { return convert(image, cv::COLOR_BGR2YCrCb); }

ByteImage from_luma_chroma(const ByteImage& image) { return convert(image, cv::COLOR_YCrCb2BGR); }

Result<BackgroundSamples> sample_background(Video& video, std::optional<int64_t> end_ns, ProgressSink* progress) {
  const int64_t limit = max_samples(video);
  int64_t expected = video.num_frames_hint();
  if (end_ns) {
    const auto until_end = static_cast<int64_t>(std::ceil(static_cast<double>(*end_ns) * 1e-9 * video.fps()));
    expected = expected == 0 ? until_end : std::min(expected, until_end);
  }
  int64_t stride = std::max<int64_t>(1, (expected + limit - 1) / limit);
  BackgroundSamples samples;
  std::optional<int64_t> first_ns;
  for (int64_t done = 0;;) {
    Result<std::optional<Frame>> frame = video.next();
    if (!frame) return frame.failure();
    if (!frame->has_value()) break;
    if (!first_ns) first_ns = (*frame)->time_ns;  // not 0 where images are numbered
    if (end_ns && (*frame)->time_ns - *first_ns >= *end_ns) {
      samples.next_index = (*frame)->index;
      break;
    }
    if (done++ % stride == 0) samples.images.push_back(to_luma_chroma((*frame)->images[0]));
    if (static_cast<int64_t>(samples.images.size()) > limit) {  // longer than was announced: keep every other one
      for (size_t i = 0; 2 * i < samples.images.size(); ++i) samples.images[i] = std::move(samples.images[2 * i]);
      samples.images.resize((samples.images.size() + 1) / 2);
      stride *= 2;
    }
    if (progress != nullptr && !progress->update("background", done, expected)) {
      return error("{}: stopped while its background was learned", video.name());
    }
  }
  if (samples.images.empty()) return error("{}: no frame to learn a background from", video.name());
  return samples;
}

BackgroundModel learn_background(const BackgroundSamples& samples) {
  check(!samples.images.empty(), "learn_background: no samples");
  const int width = samples.images[0].width(), height = samples.images[0].height();
  BackgroundModel model{.median = ByteImage(width, height, 3), .noise = Image<float>(width, height, 3)};
  median_and_deviation(samples.images, model.median, model.noise);
  cv::Mat noise(height, width, CV_32FC3, model.noise.pixels().data());
  noise += slope_of(model.median, kNoiseOfSlope);
  steady_noise(model.noise, kNoiseFloor);
  return model;
}

BackgroundModel background_from_plate(const ByteImage& plate, const BackgroundSamples& samples) {
  BackgroundModel model{.median = to_luma_chroma(plate), .noise = Image<float>(plate.width(), plate.height(), 3)};
  if (!samples.images.empty()) {
    check(samples.images[0].width() == plate.width() && samples.images[0].height() == plate.height(),
          "background_from_plate: plate {}x{}, samples {}x{}", plate.width(), plate.height(), samples.images[0].width(),
          samples.images[0].height());
    ByteImage ignored(plate.width(), plate.height(), 3);
    median_and_deviation(samples.images, ignored, model.noise);
  }
  // Where the subject comes and goes the deviation is not noise: it is limited to a few floors. A plate is its own
  // exposure and may lie a fraction of a pixel off, hence the slope of the image.
  cv::Mat noise(plate.height(), plate.width(), CV_32FC3, model.noise.pixels().data());
  const cv::Mat slope = slope_of(model.median, kPlateNoiseOfSlope);
  noise = cv::min(noise, 3 * cv::Scalar(kPlateFloor[0], kPlateFloor[1], kPlateFloor[2])) + slope;
  steady_noise(model.noise, kPlateFloor);
  return model;
}

}  // namespace silpose
