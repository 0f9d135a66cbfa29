#include "silpose/segment/chroma_segmenter.h"

#include <algorithm>
#include <utility>

#include "silpose/segment/blob_segmenter.h"

namespace silpose {
namespace {

constexpr double kGap = 0.003;  // CleanUpOptions::join_gap: a key cuts few limbs [tuned on the rendered walk, side]
// [guess] Parts of the image and of the screen's hull from which, and below which, a warning is due.
constexpr double kMuchOutside = 0.01, kLittleScreen = 0.6;

class ChromaSegmenter : public BlobSegmenter {
 public:
  ChromaSegmenter(ScreenModel model, const std::string& input, const CleanUpOptions& clean_up)
      : BlobSegmenter(clean_up.garbage_mask ? clean_up.garbage_mask : model.inside),
        model_(std::move(model)),
        clean_up_(clean_up) {
    clean_up_.join_gap = std::min(clean_up_.join_gap, kGap);
    if (model_.filled < kLittleScreen) {
      warnings_.push_back(fmt::format("{}: only {:.0f} % of what should be the screen ever has its colour ({})", input,
                                      100 * model_.filled, name()));
    }
    if (clean_up_.garbage_mask) return;
    const double pixels = static_cast<double>(model_.width()) * model_.height();
    const double outside = 1 - static_cast<double>(model_.inside.count()) / pixels;
    if (outside > kMuchOutside) {
      warnings_.push_back(fmt::format(
          "{}: {:.0f} % of the image lies outside the screen and is left out (--garbage-mask says what to leave out)",
          input, 100 * outside));
    }
    clean_up_.garbage_mask = model_.inside;
  }

  Result<Observation> segment(const ByteImage& image, int64_t index) override {
    if (image.width() != model_.width() || image.height() != model_.height()) {
      return error("frame {}: {}x{}, its screen {}x{}", index, image.width(), image.height(), model_.width(),
                   model_.height());
    }
    return judge(subject_of(find_before_screen(model_, to_luma_chroma(image)), clean_up_));
  }
  [[nodiscard]] std::vector<std::string> warnings() const override { return warnings_; }
  [[nodiscard]] std::string name() const final {
    return fmt::format("chroma #{:02x}{:02x}{:02x}", model_.key[0], model_.key[1], model_.key[2]);
  }

 private:
  ScreenModel model_;
  CleanUpOptions clean_up_;
  std::vector<std::string> warnings_;
};

}  // namespace

std::unique_ptr<Segmenter> make_chroma_segmenter(ScreenModel model, const std::string& input,
                                                 const CleanUpOptions& clean_up) {
  return std::make_unique<ChromaSegmenter>(std::move(model), input, clean_up);
}

}  // namespace silpose
