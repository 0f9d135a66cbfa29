// PersonNetwork: in a square of the image, the mask of the person in it and the landmarks of the body, by a trained
// network; and PersonDetector, which finds such squares.
// Based on: BlazePose (references.bib: bazarevsky2020) and the weights that scripts/fetch-network-data fetches; the
// rule of its anchors is that of SSD (references.bib: liu2016ssd). Threads: one thread per object; works on all cores
// itself.
#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/image/image.h"
#include "silpose/image/keypoint2d.h"
#include "silpose/image/keypoints3d.h"
#include "silpose/image/mask.h"
#include "silpose/segment/image_square.h"
#include "silpose/segment/tflite_network.h"

namespace silpose {

struct PersonLandmark {
  double x = 0, y = 0;    // in the image
  double visibility = 0;  // 0 to 1
  // Metres about the middle between the hips, axes as Keypoints3D has them.
  std::array<double, 3> in_space = {};
};

// Of the landmarks, the 33 of the body come first; then the middle of the person and a point straight above it.
// [definition]
inline constexpr size_t kPersonMiddle = 33, kAbovePerson = 34, kNumPersonLandmarks = 39;

struct PersonReading {
  double presence = 0;                    // 0 to 1: whether a person is there at all
  std::vector<PersonLandmark> landmarks;  // [39]
  ImageSquare square;                     // where this was read
  std::vector<float> mask_logits;         // [256, 256] of the square; above 0: person

  // Where to look for the same person again.
  [[nodiscard]] ImageSquare next_square() const;
  // Those that are joints, or end points, of the human, under its names.
  [[nodiscard]] std::vector<Keypoint2D> body_keypoints_2d() const;
  [[nodiscard]] Keypoints3D body_keypoints_3d() const;
  // [height, width]; far below 0 outside of the square.
  [[nodiscard]] Image<float> logits_in_image(int width, int height) const;
};

class PersonNetwork {
 public:
  // Errors: the file is not in that folder, damaged, or another network.
  static Result<PersonNetwork> load(const std::filesystem::path& folder);

  // Of an image [H, W, 3] in B, G, R.
  PersonReading read(const ByteImage& image, const ImageSquare& square);

 private:
  explicit PersonNetwork(TfliteNetwork network) : network_(std::move(network)) {}
  TfliteNetwork network_;
};

struct PersonDetection {
  double score = 0;    // 0 to 1
  ImageSquare square;  // for PersonNetwork::read()
};

class PersonDetector {
 public:
  // Errors: as PersonNetwork::load().
  static Result<PersonDetector> load(const std::filesystem::path& folder);

  // The persons in an upright square of the image, the most certain first, none twice. A person who fills less than
  // about a fifth of it is not detected.
  std::vector<PersonDetection> detect(const ByteImage& image, const ImageSquare& square);

 private:
  explicit PersonDetector(TfliteNetwork network) : network_(std::move(network)) {}
  TfliteNetwork network_;
};

// Whether a folder has what both need.
bool has_person_networks(const std::filesystem::path& folder);

}  // namespace silpose
