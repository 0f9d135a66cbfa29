#include "silpose/segment/depth_segmenter.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "silpose/segment/blob_segmenter.h"

namespace silpose {
namespace {

constexpr double kLittleMoves = 0.002;  // [guess] of the image

class DepthSegmenter : public BlobSegmenter {
 public:
  DepthSegmenter(DepthFiles depth, const std::optional<DepthRange>& range, const CleanUpOptions& clean_up)
      : BlobSegmenter(clean_up.garbage_mask), depth_(std::move(depth)), range_(range), clean_up_(clean_up) {}

  Result<void> learn(ProgressSink* progress) {
    // Of a range nothing is to be learned, but the first one has to fit.
    const Result<std::vector<DepthImage>> samples = depth_.samples(range_ ? 1 : kDepthSamples, progress);
    if (!samples) return samples.failure();
    if (range_) return {};
    background_ = learn_depth_background(*samples);
    int64_t most = 0;
    for (const DepthImage& image : *samples) most = std::max(most, nearer_than_background(image, background_).count());
    if (static_cast<double>(most) < kLittleMoves * depth_.width * depth_.height) {
      warnings_.push_back(fmt::format(
          "{}: almost nothing is ever nearer than the background; a static subject is mistaken for background "
          "(--depth-range MIN,MAX helps)",
          depth_.name));
    }
    return {};
  }

  Result<Observation> segment(const ByteImage&, int64_t index) override {
    const Result<DepthImage> depth = depth_.image_of(index);
    if (!depth) return depth.failure();
    const Mask before = range_ ? within_depth_range(*depth, *range_) : nearer_than_background(*depth, background_);
    return judge(subject_of(before, clean_up_));
  }
  [[nodiscard]] int64_t first_index() const override { return depth_.first_number() + depth_.offset; }
  [[nodiscard]] std::vector<std::string> warnings() const override { return warnings_; }
  [[nodiscard]] std::string name() const override {
    return range_ ? fmt::format("depth {:g} to {:g} m", range_->min_m, range_->max_m) : "depth auto";
  }

 private:
  DepthFiles depth_;
  std::optional<DepthRange> range_;
  CleanUpOptions clean_up_;
  DepthImage background_;
  std::vector<std::string> warnings_;
};

}  // namespace

Result<std::unique_ptr<Segmenter>> make_depth_segmenter(DepthFiles depth, const std::optional<DepthRange>& range,
                                                        const CleanUpOptions& clean_up, ProgressSink* progress) {
  auto segmenter = std::make_unique<DepthSegmenter>(std::move(depth), range, clean_up);
  if (const Result<void> learned = segmenter->learn(progress); !learned) return learned.failure();
  return std::unique_ptr<Segmenter>(std::move(segmenter));
}

}  // namespace silpose
