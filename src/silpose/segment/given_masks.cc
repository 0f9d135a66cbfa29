#include "silpose/segment/given_masks.h"

#include <algorithm>
#include <utility>

#include "silpose/segment/trust_monitor.h"

namespace silpose {
namespace {

Mask white_of(const ByteImage& image) {
  ByteImage grey(image.width(), image.height());
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const int sum = image.at(x, y, 0) + 2 * image.at(x, y, 1) + image.at(x, y, 2);
      grey.at(x, y) = static_cast<uint8_t>(sum / 4);
    }
  }
  return mask_from_image(grey);
}

class GivenMasks : public Segmenter {
 public:
  GivenMasks(std::optional<Video> masks, int64_t offset, const CleanUpOptions& clean_up)
      : masks_(std::move(masks)), offset_(offset), clean_up_(clean_up) {
    is_cleaned_ = clean_up.region || clean_up.garbage_mask || clean_up.grow_px != 0 || clean_up.min_blob_px > 0;
    clean_up_.max_hole = clean_up_.join_gap = 0;  // whoever made the masks meant their holes and gaps
    clean_up_.min_blob_px = std::max(clean_up_.min_blob_px, 0);
  }

  Result<Segmentation> segment(const ByteImage& image, int64_t index) override {
    check(image.channels() == 3, "GivenMasks: {} channels", image.channels());
    if (!masks_) return judge(white_of(image));
    while (true) {
      Result<std::optional<Frame>> frame = masks_->next();
      if (!frame) return frame.failure();
      if (!frame->has_value() || (*frame)->index + offset_ > index) {
        return error("{}: {} masks, frame {} has none", masks_->name(), num_read_, index);
      }
      ++num_read_;
      if ((*frame)->index + offset_ < index) continue;
      const ByteImage& mask = (*frame)->images[0];
      if (mask.width() != image.width() || mask.height() != image.height()) {
        return error("{}: mask {} is {}x{}, its picture {}x{}", masks_->name(), index, mask.width(), mask.height(),
                     image.width(), image.height());
      }
      return judge(white_of(mask));
    }
  }
  [[nodiscard]] std::string name() const override { return "masks"; }
  [[nodiscard]] int64_t first_index() const override { return masks_ ? masks_->first_index() + offset_ : 0; }

 private:
  Segmentation judge(const Mask& mask) { return monitor_.judge(is_cleaned_ ? choose_blob(mask, clean_up_) : mask); }

  std::optional<Video> masks_;
  int64_t offset_;
  CleanUpOptions clean_up_;
  bool is_cleaned_ = false;
  int64_t num_read_ = 0;
  TrustMonitor monitor_;
};

}  // namespace

std::unique_ptr<Segmenter> make_given_masks(std::optional<Video> masks, int64_t offset,
                                            const CleanUpOptions& clean_up) {
  return std::make_unique<GivenMasks>(std::move(masks), offset, clean_up);
}

}  // namespace silpose
