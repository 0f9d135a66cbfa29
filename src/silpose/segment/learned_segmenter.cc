#include "silpose/segment/learned_segmenter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "silpose/base/state_bytes.h"
#include "silpose/segment/edge_matte.h"
#include "silpose/segment/mask_confidence.h"
#include "silpose/segment/plate.h"
#include "silpose/segment/trust_monitor.h"

namespace silpose {
namespace {

// Run again where it found a person, the network grows more confident of one: what is new has to convince it at first
// sight. [guess]
constexpr double kPresentAtFirst = 0.8, kStillPresent = 0.5;
constexpr int kMaxLooks = 8;                              // until the square fits the person
constexpr std::array<double, 3> kZooms = {1, 1.75, 3.5};  // small persons are detected in parts of the image,
constexpr int kSearchEvery = 10;                          // but not in every image without a person
constexpr double kMinSide = 24;                           // px, of a square with a person
constexpr float kSureLogit = 5;                           // belief from which a pixel is certain
constexpr size_t kMaxLearned = 40;                        // images from which a background is learned

bool is_settled(const ImageSquare& before, const ImageSquare& after) {
  const double turned = std::remainder(after.turn_rad - before.turn_rad, 2 * std::numbers::pi);
  return std::hypot(after.x - before.x, after.y - before.y) < 0.02 * after.side &&
         std::abs(after.side - before.side) < 0.02 * after.side && std::abs(turned) < 0.03;
}

class LearnedSegmenter : public Segmenter {
 public:
  LearnedSegmenter(PersonNetwork network, PersonDetector detector, const CleanUpOptions& clean_up)
      : network_(std::move(network)),
        detector_(std::move(detector)),
        clean_up_(clean_up),
        monitor_(removed_by(clean_up.garbage_mask)) {}

  // A few dozen images show what is behind; the network is slow.
  void learn(const BackgroundSamples& samples) {
    const size_t step = (samples.images.size() + kMaxLearned - 1) / kMaxLearned;
    std::vector<ByteImage> images;
    std::vector<Mask> masks;
    for (size_t i = 0; i < samples.images.size(); i += step) {
      images.push_back(samples.images[i]);
      masks.push_back(find_mask(from_luma_chroma(samples.images[i])).kept);
    }
    plate_ = learn_plate(images, masks);
    square_.reset();
    num_without_ = num_lost_ = 0;
  }

  Result<Observation> segment(const ByteImage& image, int64_t /*index*/) override {
    Found found = find_mask(image);
    Mask mask = std::move(found.kept);
    if (plate_ && mask.count() > 0) {
      EdgeMatte matte = refine_edge(mask, to_luma_chroma(image), plate_->colours, &plate_->known);
      lower_confidence(found.confidence, matte.confidence);
      mask = std::move(matte.mask);
    }
    forgive_edges(found.confidence, mask);
    Observation judged = monitor_.judge(grow(mask, clean_up_.grow_px), std::move(found.confidence));
    judged.keypoints_2d = std::move(found.keypoints_2d);
    judged.keypoints_3d = std::move(found.keypoints_3d);
    return judged;
  }

  [[nodiscard]] std::string state() const override {
    return to_bytes(monitor_, square_, num_without_, num_lost_, saw_others_);
  }
  void restore(std::string_view state) override {
    check(from_bytes(state, monitor_, square_, num_without_, num_lost_, saw_others_),
          "LearnedSegmenter: not a state of it");
  }
  [[nodiscard]] std::vector<std::string> warnings() const override {
    std::vector<std::string> warnings;
    if (num_lost_ > 0) {
      warnings.push_back(
          fmt::format("the person was lost {} time{} and detected again: it may be another person (--region helps)",
                      num_lost_, num_lost_ == 1 ? "" : "s"));
    }
    if (saw_others_) warnings.emplace_back("several people are in the image; the largest is followed (--region helps)");
    return warnings;
  }
  [[nodiscard]] std::shared_ptr<const Mask> ignored() const override { return monitor_.ignored(); }
  [[nodiscard]] bool finds_keypoints() const override { return true; }
  [[nodiscard]] std::string name() const override { return "learned"; }

 private:
  struct Found {
    Mask kept;             // [H, W] the person, empty where there is none
    ByteImage confidence;  // [H, W]
    std::vector<Keypoint2D> keypoints_2d = {};
    Keypoints3D keypoints_3d = {};
  };

  // By the network alone; follows the person.
  Found find_mask(const ByteImage& image) {
    std::optional<PersonReading> reading;
    if (square_) {
      reading = network_.read(image, *square_);
      if (!can_go_on(*reading, kStillPresent)) {
        reading.reset();
        ++num_lost_;
      }
    }
    if (!reading) reading = find(image);
    Found found{Mask(image.width(), image.height()), ByteImage(image.width(), image.height(), 1, 255)};
    if (reading) {
      const Image<float> logits = reading->logits_in_image(image.width(), image.height());
      Mask person(image.width(), image.height());
      for (int y = 0; y < image.height(); ++y) {
        const auto row = logits.row(y);
        for (int x = 0; x < image.width(); ++x) {
          const float logit = row[static_cast<size_t>(x)];
          if (logit > 0) person.set(x, y);
          // Twice the distance of the probability from a half.
          if (std::abs(logit) < kSureLogit) {
            found.confidence.at(x, y) = static_cast<uint8_t>(255 * std::tanh(0.5f * std::abs(logit)));
          }
        }
      }
      CleanUpOptions whole = clean_up_;
      whole.grow_px = 0;  // last
      found.kept = choose_blob(person, whole);
      doubt_changes(found.confidence, person, found.kept);
    }
    square_.reset();
    if (found.kept.count() > 0) {
      square_ = reading->next_square();
      found.keypoints_2d = reading->body_keypoints_2d();
      found.keypoints_3d = reading->body_keypoints_3d();
    }
    num_without_ = square_ ? 0 : num_without_ + 1;
    return found;
  }

  static bool can_go_on(const PersonReading& reading, double least_presence) {
    const ImageSquare next = reading.next_square();
    return reading.presence >= least_presence && next.side >= kMinSide && next.side < 1e5;
  }

  std::optional<PersonReading> find(const ByteImage& image) {
    Box area{0, 0, image.width(), image.height()};
    if (clean_up_.region) area = *clean_up_.region;
    const size_t num_levels = num_without_ % kSearchEvery == 0 ? kZooms.size() : 1;
    for (size_t level = 0; level < num_levels; ++level) {
      const double side = std::max(area.width, area.height) / kZooms[level];
      std::vector<PersonDetection> found;
      for (const ImageSquare& tile : tiles(area, side)) {
        for (const PersonDetection& detection : detector_.detect(image, tile)) {
          const ImageSquare& at = detection.square;
          if (at.side >= kMinSide && at.x >= area.x && at.x < area.x + area.width && at.y >= area.y &&
              at.y < area.y + area.height) {
            found.push_back(detection);
          }
        }
      }
      saw_others_ = saw_others_ || (level == 0 && found.size() > 1);
      std::ranges::stable_sort(found, std::greater<>(),
                               [](const PersonDetection& detection) { return detection.square.side; });
      for (const PersonDetection& detection : found) {
        PersonReading reading = network_.read(image, detection.square);
        if (!can_go_on(reading, kPresentAtFirst)) continue;
        for (int look = 1; look < kMaxLooks && !is_settled(reading.square, reading.next_square()); ++look) {
          PersonReading again = network_.read(image, reading.next_square());
          if (!can_go_on(again, kStillPresent)) break;
          reading = std::move(again);
        }
        return reading;
      }
    }
    return std::nullopt;
  }

  // Upright squares that cover the area and overlap by half.
  static std::vector<ImageSquare> tiles(const Box& area, double side) {
    const auto count = [&](int length) { return std::max(1, static_cast<int>(std::ceil(2 * length / side)) - 1); };
    const auto middle = [&](int start, int length, int i, int n) {
      if (n == 1) return start + 0.5 * length;
      return start + 0.5 * side + i * (length - side) / (n - 1);
    };
    const int columns = count(area.width), rows = count(area.height);
    std::vector<ImageSquare> squares;
    for (int row = 0; row < rows; ++row) {
      for (int column = 0; column < columns; ++column) {
        squares.push_back(
            {middle(area.x, area.width, column, columns), middle(area.y, area.height, row, rows), side, 0});
      }
    }
    return squares;
  }

  PersonNetwork network_;
  PersonDetector detector_;
  CleanUpOptions clean_up_;
  TrustMonitor monitor_;
  std::optional<Plate> plate_;
  std::optional<ImageSquare> square_;  // where the person is looked for next
  int num_without_ = 0;                // images since a person was seen
  int num_lost_ = 0;
  bool saw_others_ = false;
};

}  // namespace

std::unique_ptr<Segmenter> make_learned_segmenter(PersonNetwork network, PersonDetector detector,
                                                  const CleanUpOptions& clean_up,
                                                  const std::optional<BackgroundSamples>& samples) {
  auto segmenter = std::make_unique<LearnedSegmenter>(std::move(network), std::move(detector), clean_up);
  if (samples) segmenter->learn(*samples);
  return segmenter;
}

}  // namespace silpose
