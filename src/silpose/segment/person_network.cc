#include "silpose/segment/person_network.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace silpose {
namespace {

constexpr const char *kLandmarkFile = "pose_landmark_full.tflite", *kDetectionFile = "pose_detection.tflite";
// [definition] of the network's files: sizes of its inputs, pixels, and number of its anchors.
constexpr int kReadSize = 256, kDetectSize = 224;
constexpr size_t kNumAnchors = 2254;
constexpr double kSureEnough = 0.5, kSamePerson = 0.3;  // [guess] probability; overlap of two boxes

// Which of the network's landmarks are points of the human body. Those of the face are no joints.
// [definition]
constexpr std::pair<const char*, size_t> kOfBody[] = {
    {"left_upper_arm", 11}, {"right_upper_arm", 12}, {"left_forearm", 13}, {"right_forearm", 14}, {"left_hand", 15},
    {"right_hand", 16},     {"left_thigh", 23},      {"right_thigh", 24},  {"left_shin", 25},     {"right_shin", 26},
    {"left_foot", 27},      {"right_foot", 28},      {"left_toe_tip", 31}, {"right_toe_tip", 32}};

double probability(double logit) { return 1 / (1 + std::exp(-logit)); }

Result<TfliteNetwork> load_network(const std::filesystem::path& file, const std::vector<std::string>& outputs, int size,
                                   const std::vector<std::vector<int>>& shapes) {
  std::error_code failed;
  if (!std::filesystem::exists(file, failed)) {
    return error("{}: no such file; scripts/fetch-network-data fetches it", file.string());
  }
  Result<TfliteNetwork> network = TfliteNetwork::load(file, outputs);
  if (!network) return network.failure();
  if (network->input_shape() != std::vector<int>{size, size, 3} || network->output_shapes() != shapes) {
    return error("{}: another network than the one expected", file.string());
  }
  return network;
}

// Middles of the anchors, from 0 to 1 of the square: cells of 8, 16 and 32 pixels, two to a cell and layer, where
// three layers share the last.
std::vector<std::array<double, 2>> make_anchors() {
  std::vector<std::array<double, 2>> anchors;
  for (const auto& [stride, count] : {std::pair{8, 2}, {16, 2}, {32, 6}}) {
    const int cells = kDetectSize / stride;
    for (int y = 0; y < cells; ++y) {
      for (int x = 0; x < cells; ++x)
        anchors.insert(anchors.end(), static_cast<size_t>(count), {(x + 0.5) / cells, (y + 0.5) / cells});
    }
  }
  return anchors;
}

struct FoundBox {
  double score = 0, x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // from 0 to 1 of the square
  double middle_x = 0, middle_y = 0, above_x = 0, above_y = 0;
};

double overlap(const FoundBox& a, const FoundBox& b) {
  const double width = std::min(a.x1, b.x1) - std::max(a.x0, b.x0),
               height = std::min(a.y1, b.y1) - std::max(a.y0, b.y0);
  if (width <= 0 || height <= 0) return 0;
  const double both = width * height;
  return both / ((a.x1 - a.x0) * (a.y1 - a.y0) + (b.x1 - b.x0) * (b.y1 - b.y0) - both);
}

}  // namespace

ImageSquare PersonReading::next_square() const {
  const PersonLandmark &middle = landmarks[kPersonMiddle], &above = landmarks[kAbovePerson];
  return square_around(middle.x, middle.y, above.x, above.y);
}

std::vector<Keypoint2D> PersonReading::body_keypoints_2d() const {
  std::vector<Keypoint2D> seen;
  for (const auto& [name, i] : kOfBody) seen.push_back({name, landmarks[i].x, landmarks[i].y, landmarks[i].visibility});
  return seen;
}

Keypoints3D PersonReading::body_keypoints_3d() const {
  Keypoints3D keypoints{square.x, square.y, {}};
  for (const auto& [name, i] : kOfBody) {
    keypoints.points.push_back({name, landmarks[i].in_space, landmarks[i].visibility});
  }
  return keypoints;
}

Image<float> PersonReading::logits_in_image(int width, int height) const {
  return values_in_image(mask_logits, kReadSize, square, width, height, -10);
}

Result<PersonNetwork> PersonNetwork::load(const std::filesystem::path& folder) {
  Result<TfliteNetwork> network =
      load_network(folder / kLandmarkFile, {"Identity", "Identity_1", "Identity_2", "Identity_4"}, kReadSize,
                   {{1, 195}, {1, 1}, {1, kReadSize, kReadSize, 1}, {1, 117}});
  if (!network) return network.failure();
  return PersonNetwork(std::move(*network));
}

PersonReading PersonNetwork::read(const ByteImage& image, const ImageSquare& square) {
  std::vector<std::vector<float>> outputs = network_.run(sample_square(image, square, kReadSize));
  PersonReading reading{.presence = outputs[1][0], .square = square, .mask_logits = std::move(outputs[2])};
  reading.landmarks.resize(kNumPersonLandmarks);
  for (size_t i = 0; i < kNumPersonLandmarks; ++i) {
    const float* values = &outputs[0][5 * i];  // x, y, z, visibility, presence
    const auto [x, y] = square.in_image(values[0] / kReadSize, values[1] / kReadSize);
    // In space the square is upright: its turn is undone about the viewing ray.
    const float* in_space = &outputs[3][3 * i];
    const double c = std::cos(square.turn_rad), s = std::sin(square.turn_rad);
    reading.landmarks[i] = {x,
                            y,
                            probability(values[3]),
                            {c * in_space[0] - s * in_space[1], s * in_space[0] + c * in_space[1], in_space[2]}};
  }
  return reading;
}

Result<PersonDetector> PersonDetector::load(const std::filesystem::path& folder) {
  const int count = static_cast<int>(kNumAnchors);
  Result<TfliteNetwork> network =
      load_network(folder / kDetectionFile, {"Identity", "Identity_1"}, kDetectSize, {{1, count, 12}, {1, count, 1}});
  if (!network) return network.failure();
  return PersonDetector(std::move(*network));
}

std::vector<PersonDetection> PersonDetector::detect(const ByteImage& image, const ImageSquare& square) {
  std::vector<float> input = sample_square(image, square, kDetectSize);
  for (float& value : input) value = 2 * value - 1;
  const std::vector<std::vector<float>> outputs = network_.run(input);

  static const std::vector<std::array<double, 2>> anchors = make_anchors();
  std::vector<FoundBox> boxes;
  for (size_t i = 0; i < kNumAnchors; ++i) {
    const double score = probability(outputs[1][i]);
    if (!(score >= kSureEnough)) continue;
    const float* raw = &outputs[0][12 * i];  // middle and size of the box, then four points
    const auto at = [&](size_t k) { return anchors[i][k % 2] + raw[k] / kDetectSize; };
    const double half_width = 0.5 * raw[2] / kDetectSize, half_height = 0.5 * raw[3] / kDetectSize;
    boxes.push_back({score, at(0) - half_width, at(1) - half_height, at(0) + half_width, at(1) + half_height, at(4),
                     at(5), at(6), at(7)});
  }
  std::ranges::stable_sort(boxes, std::greater<>(), &FoundBox::score);
  std::vector<FoundBox> kept;
  std::vector<PersonDetection> detections;
  for (const FoundBox& box : boxes) {
    if (std::ranges::any_of(kept, [&](const FoundBox& other) { return overlap(box, other) > kSamePerson; })) continue;
    kept.push_back(box);
    const auto [x, y] = square.in_image(box.middle_x, box.middle_y);
    const auto [up_x, up_y] = square.in_image(box.above_x, box.above_y);
    detections.push_back({box.score, square_around(x, y, up_x, up_y)});
  }
  return detections;
}

bool has_person_networks(const std::filesystem::path& folder) {
  std::error_code failed;
  return std::filesystem::exists(folder / kLandmarkFile, failed) &&
         std::filesystem::exists(folder / kDetectionFile, failed);
}

}  // namespace silpose
