#include "silpose/segment/background_segmenter.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/background_segm.hpp>
#include <optional>
#include <utility>

#include "silpose/segment/blob_segmenter.h"
#include "silpose/segment/edge_matte.h"
#include "silpose/segment/foreground.h"
#include "silpose/segment/mask_confidence.h"

namespace silpose {
namespace {

class BackgroundSegmenter : public BlobSegmenter {
 public:
  BackgroundSegmenter(BackgroundModel model, BackgroundSegmenterOptions options)
      : BlobSegmenter(options.clean_up.garbage_mask),
        options_(std::move(options)),
        finder_(std::move(model)),
        blob_(options_.clean_up) {
    blob_.grow_px = 0;  // last
    blob_.join_gap = std::min(blob_.join_gap, kGap);
  }

  void prepare(const ByteImage& image, int64_t index) override { prepared_.emplace(index, look_at(image, index)); }

  Result<Observation> segment(const ByteImage& image, int64_t index) override {
    const auto prepared = std::exchange(prepared_, std::nullopt);
    Result<Look> look = prepared && prepared->first == index ? prepared->second : look_at(image, index);
    if (!look) return look.failure();
    const Mask blob = subject_of(look->found, blob_);
    doubt_changes(look->confidence, look->found, blob);
    const int grow_px = options_.clean_up.grow_px;
    // Colour alone must not decide the edge where depth was used.
    if (options_.depth) return judge(grow(blob, grow_px), std::move(look->confidence));
    const EdgeMatte matte = refine_edge(blob, look->luma_chroma, finder_.model().median);
    lower_confidence(look->confidence, matte.confidence);
    forgive_edges(look->confidence, matte.mask);
    return judge(grow(matte.mask, grow_px), std::move(look->confidence));
  }
  [[nodiscard]] int64_t first_index() const override { return options_.first_index; }
  [[nodiscard]] std::vector<std::string> warnings() const override { return options_.warnings; }
  [[nodiscard]] std::string name() const override { return options_.name; }

 private:
  // All foreground of an image, not only the subject's.
  struct Look {
    ByteImage luma_chroma;
    Mask found;
    ByteImage confidence;
  };
  Result<Look> look_at(const ByteImage& image, int64_t index) {
    if (image.width() != finder_.model().width() || image.height() != finder_.model().height()) {
      return error("frame {}: {}x{}, its background {}x{}", index, image.width(), image.height(),
                   finder_.model().width(), finder_.model().height());
    }
    std::optional<Image<float>> depth;
    if (options_.depth) {
      const Result<DepthImage> seen = options_.depth->files.image_of(index);
      if (!seen) return seen.failure();
      depth = depth_evidence(*seen, options_.depth->background);
    }
    Look look{.luma_chroma = to_luma_chroma(image)};
    look.found = finder_.find(look.luma_chroma, depth ? &*depth : nullptr);
    look.confidence = finder_.confidence(look.found);
    return look;
  }

  static constexpr double kGap = 0.003;  // [guess] of the image's height: fingers and knees stay apart
  BackgroundSegmenterOptions options_;
  ForegroundFinder finder_;
  CleanUpOptions blob_;
  std::optional<std::pair<int64_t, Result<Look>>> prepared_;  // by the image's number
};

class OnlineSegmenter : public BlobSegmenter {
 public:
  OnlineSegmenter(OnlineMixture mixture, BackgroundSegmenterOptions options)
      : BlobSegmenter(options.clean_up.garbage_mask), options_(std::move(options)) {
    if (mixture == OnlineMixture::kMog2) {
      subtractor_ = cv::createBackgroundSubtractorMOG2(kHistory, 25, true);
    } else {
      subtractor_ = cv::createBackgroundSubtractorKNN(kHistory, 600, true);
    }
  }

  Result<Observation> segment(const ByteImage& image, int64_t index) override {
    check(image.channels() == 3, "OnlineSegmenter: {} channels", image.channels());
    if (num_seen_ > 0 && (image.width() != size_.width || image.height() != size_.height)) {
      return error("frame {}: {}x{}, those before it {}x{}", index, image.width(), image.height(), size_.width,
                   size_.height);
    }
    size_ = cv::Size(image.width(), image.height());
    const cv::Mat view(size_, CV_8UC3, const_cast<uint8_t*>(image.pixels().data()));
    cv::Mat labels;
    // Left to themselves the mixtures learn so fast at first that a subject who comes then becomes background.
    subtractor_->apply(view, labels, num_seen_ < kNumLearned ? -1 : 1.0 / kHistory);
    labels = labels == 255;  // 127 is shadow
    cv::medianBlur(labels, labels, 5);
    ByteImage bytes(image.width(), image.height());
    labels.copyTo(cv::Mat(size_, CV_8U, bytes.pixels().data()));
    Observation result;
    if (num_seen_++ < kNumLearned) {
      result.mask = Mask(image.width(), image.height());
      result.trust.nothing_found = true;
      result.trust.overall = 0;
      return result;
    }
    return judge(subject_of(mask_from_image(bytes), options_.clean_up));
  }
  [[nodiscard]] bool sees_all() const override { return true; }
  [[nodiscard]] std::vector<std::string> warnings() const override { return options_.warnings; }
  [[nodiscard]] std::string name() const override { return options_.name; }

 private:
  static constexpr int kHistory = 500;    // [guess] images until the oldest is forgotten
  static constexpr int kNumLearned = 10;  // [guess] images before anything is trusted
  BackgroundSegmenterOptions options_;
  cv::Ptr<cv::BackgroundSubtractor> subtractor_;
  cv::Size size_;
  int num_seen_ = 0;
};

}  // namespace

std::unique_ptr<Segmenter> make_background_segmenter(BackgroundModel model, BackgroundSegmenterOptions options) {
  return std::make_unique<BackgroundSegmenter>(std::move(model), std::move(options));
}

std::unique_ptr<Segmenter> make_online_segmenter(OnlineMixture mixture, BackgroundSegmenterOptions options) {
  return std::make_unique<OnlineSegmenter>(mixture, std::move(options));
}

}  // namespace silpose
