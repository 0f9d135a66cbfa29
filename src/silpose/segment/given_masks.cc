#include "silpose/segment/given_masks.h"

#include <algorithm>
#include <span>
#include <utility>

#include "silpose/base/state_bytes.h"
#include "silpose/segment/trust_monitor.h"

namespace silpose {
namespace {

// Nearly all pixels, as far as compression and soft edges leave them.
bool is_black_and_white(const ByteImage& image, bool& has_white) {
  // [guess]
  constexpr int kBlack = 16, kWhite = 239;
  constexpr double kNearlyAll = 0.98;
  size_t num_black = 0, num_white = 0;
  const std::span<const uint8_t> pixels = image.pixels();
  for (size_t i = 0; i + 2 < pixels.size(); i += 3) {
    const auto [least, most] = std::minmax({pixels[i], pixels[i + 1], pixels[i + 2]});
    num_black += most <= kBlack ? 1 : 0;
    num_white += least >= kWhite ? 1 : 0;
  }
  has_white = num_white > 0;
  return static_cast<double>(num_black + num_white) >= kNearlyAll * static_cast<double>(pixels.size()) / 3;
}

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
  GivenMasks(std::string name, std::optional<Video> masks, int64_t offset, const CleanUpOptions& clean_up,
             std::vector<std::string> warnings)
      : name_(std::move(name)),
        masks_(std::move(masks)),
        offset_(offset),
        clean_up_(clean_up),
        warnings_(std::move(warnings)),
        monitor_(removed_by(clean_up.garbage_mask)) {
    is_cleaned_ = clean_up.region || clean_up.garbage_mask || clean_up.grow_px != 0 || clean_up.min_blob_px > 0;
    clean_up_.max_hole = clean_up_.join_gap = 0;  // holes and gaps of given masks are intended
    clean_up_.min_blob_px = std::max(clean_up_.min_blob_px, 0);
  }

  Result<Observation> segment(const ByteImage& image, int64_t index) override {
    check(image.channels() == 3, "GivenMasks: {} channels", image.channels());
    if (!masks_) return judge(white_of(checked(image)));
    while (true) {
      Result<std::optional<Frame>> frame = masks_->next();
      if (!frame) return frame.failure();
      if (!frame->has_value() || (*frame)->index + offset_ > index) {
        return error("{}: {} masks, frame {} has none", name_, num_read_, index);
      }
      ++num_read_;
      if ((*frame)->index + offset_ < index) continue;
      const ByteImage& mask = (*frame)->images[0];
      if (mask.width() != image.width() || mask.height() != image.height()) {
        return error("{}: mask {} is {}x{}, its image {}x{}", name_, index, mask.width(), mask.height(), image.width(),
                     image.height());
      }
      return judge(white_of(checked(mask)));
    }
  }
  [[nodiscard]] std::shared_ptr<const Mask> ignored() const override { return monitor_.ignored(); }
  [[nodiscard]] bool can_go_back() const override { return false; }  // masks are read in their order
  [[nodiscard]] std::string state() const override { return to_bytes(has_warned_, warnings_, monitor_); }
  void restore(std::string_view state) override {
    check(from_bytes(state, has_warned_, warnings_, monitor_), "GivenMasks: not a state of it");
  }
  [[nodiscard]] std::string name() const override { return "masks"; }
  [[nodiscard]] std::vector<std::string> warnings() const override { return warnings_; }
  [[nodiscard]] int64_t first_index() const override { return masks_ ? masks_->first_index() + offset_ : 0; }

 private:
  // Warns once of an image that is not a mask.
  const ByteImage& checked(const ByteImage& mask) {
    bool has_white = false;
    if (!has_warned_ && !is_black_and_white(mask, has_white)) {
      has_warned_ = true;
      warnings_.push_back(fmt::format("{}: not only black and white; what is lighter than half counts", name_));
    }
    return mask;
  }
  Observation judge(const Mask& mask) { return monitor_.judge(is_cleaned_ ? choose_blob(mask, clean_up_) : mask); }

  std::string name_;
  std::optional<Video> masks_;
  int64_t offset_;
  CleanUpOptions clean_up_;
  std::vector<std::string> warnings_;
  bool is_cleaned_ = false, has_warned_ = false;
  int64_t num_read_ = 0;
  TrustMonitor monitor_;
};

}  // namespace

std::unique_ptr<Segmenter> make_given_masks(std::string name, std::optional<Video> masks, int64_t offset,
                                            const CleanUpOptions& clean_up, std::vector<std::string> warnings) {
  return std::make_unique<GivenMasks>(std::move(name), std::move(masks), offset, clean_up, std::move(warnings));
}

Result<bool> shows_masks(Video& video) {
  constexpr int kEnough = 3;  // [guess] masks in which something is white: before them, all may be black
  for (int found = 0; found < kEnough;) {
    const Result<std::optional<Frame>> frame = video.next();
    if (!frame) return frame.failure();
    if (!frame->has_value()) return found > 0;
    bool has_white = false;
    if (!is_black_and_white((*frame)->images[0], has_white)) return false;
    found += has_white ? 1 : 0;
  }
  return true;
}

}  // namespace silpose
