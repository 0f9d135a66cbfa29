#include "silpose/segment/depth_segmenter.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "silpose/segment/trust_monitor.h"

namespace silpose {
namespace {

constexpr size_t kMaxSamples = 40;
constexpr double kLittleMoves = 0.002;  // of the picture

class DepthSegmenter : public Segmenter {
 public:
  DepthSegmenter(DepthFiles depth, const std::optional<DepthRange>& range, const CleanUpOptions& clean_up)
      : depth_(std::move(depth)), range_(range), clean_up_(clean_up) {}

  Result<void> learn(int width, int height, ProgressSink* progress) {
    std::vector<DepthImage> samples;
    const std::vector<std::filesystem::path>& paths = depth_.files.paths;
    const size_t step = (paths.size() + kMaxSamples - 1) / kMaxSamples;
    for (size_t i = 0; i < paths.size(); i += step) {
      Result<DepthImage> image = read(paths[i], width, height);
      if (!image) return image.failure();
      samples.push_back(std::move(*image));
      if (range_) return {};  // nothing to learn, but the first one has to fit
      if (progress != nullptr && !progress->update("background", std::ssize(samples),
                                                   static_cast<int64_t>((paths.size() + step - 1) / step))) {
        return error("{}: stopped while its background was learned", depth_.name);
      }
    }
    background_ = learn_depth_background(samples);
    int64_t most = 0;
    for (const DepthImage& image : samples) most = std::max(most, nearer_than_background(image, background_).count());
    if (static_cast<double>(most) < kLittleMoves * width * height) {
      warnings_.push_back(
          fmt::format("{}: next to nothing ever stands before the background; a subject who stays put is taken for it "
                      "(--depth-range MIN,MAX helps)",
                      depth_.name));
    }
    return {};
  }

  Result<Segmentation> segment(const ByteImage& image, int64_t index) override {
    const int64_t number = index - depth_.offset;
    const std::vector<int64_t>& numbers = depth_.files.numbers;
    auto at = static_cast<size_t>(std::max<int64_t>(number, 0));
    bool found = number >= 0 && at < depth_.files.paths.size();
    if (!numbers.empty()) {
      const auto place = std::lower_bound(numbers.begin(), numbers.end(), number);
      at = static_cast<size_t>(place - numbers.begin());
      found = place != numbers.end() && *place == number;
    }
    if (!found) return error("{}: {} depth images, frame {} has none", depth_.name, depth_.files.paths.size(), index);
    const Result<DepthImage> depth = read(depth_.files.paths[at], image.width(), image.height());
    if (!depth) return depth.failure();
    const Mask before = range_ ? within_depth_range(*depth, *range_) : nearer_than_background(*depth, background_);
    return monitor_.judge(choose_blob(before, clean_up_));
  }
  [[nodiscard]] int64_t first_index() const override { return depth_.first_number() + depth_.offset; }
  [[nodiscard]] std::vector<std::string> warnings() const override { return warnings_; }
  [[nodiscard]] std::string name() const override {
    return range_ ? fmt::format("depth {:g} to {:g} m", range_->min_m, range_->max_m) : "depth auto";
  }

 private:
  static Result<DepthImage> read(const std::filesystem::path& path, int width, int height) {
    Result<DepthImage> image = read_depth_image(path);
    if (image && (image->width() != width || image->height() != height)) {
      return error("{}: depth of {}x{} for pictures of {}x{}", path.string(), image->width(), image->height(), width,
                   height);
    }
    return image;
  }

  DepthFiles depth_;
  std::optional<DepthRange> range_;
  CleanUpOptions clean_up_;
  DepthImage background_;
  std::vector<std::string> warnings_;
  TrustMonitor monitor_;
};

}  // namespace

Result<std::unique_ptr<Segmenter>> make_depth_segmenter(DepthFiles depth, int width, int height,
                                                        const std::optional<DepthRange>& range,
                                                        const CleanUpOptions& clean_up, ProgressSink* progress) {
  auto segmenter = std::make_unique<DepthSegmenter>(std::move(depth), range, clean_up);
  if (const Result<void> learned = segmenter->learn(width, height, progress); !learned) return learned.failure();
  return std::unique_ptr<Segmenter>(std::move(segmenter));
}

}  // namespace silpose
