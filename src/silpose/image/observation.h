// Observation: what one camera saw of the subject at one instant: made by a segmenter, compared by a likelihood.
// Threads: a value.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "silpose/image/image.h"
#include "silpose/image/keypoint2d.h"
#include "silpose/image/keypoints3d.h"
#include "silpose/image/mask.h"

namespace silpose {

struct Trust {
  double overall = 1;           // 0: ignore this frame (the tracker coasts); 1: as good as a given mask
  bool nothing_found = false;   // no blob counts
  bool touches_border = false;  // part of the subject may be outside the image
  bool area_jumped = false;     // area changed by more than the segmenter's limit against the recent median

  static auto members(auto& t) { return std::tie(t.overall, t.nothing_found, t.touches_border, t.area_jumped); }
};

struct Observation {
  Mask mask;                                     // [H, W] the subject's silhouette
  ByteImage confidence = {};                     // [H, W] of each pixel, 255: certain; empty: certain everywhere
  std::shared_ptr<const Mask> ignored = {};      // [H, W] pixels of which nothing is known; null: none
  std::shared_ptr<const DepthImage> depth = {};  // [H, W]; null: none. Segmenters give none, programs may
  std::vector<Keypoint2D> keypoints_2d = {};     // of the body; empty from most segmenters
  Keypoints3D keypoints_3d = {};                 // the same in space
  Trust trust = {};
  int64_t time_ns = 0;  // of the image

  // The smallest box around the mask; empty where nothing was found.
  [[nodiscard]] Box box() const { return mask.bounding_box(); }
  // A silhouette without the ignored pixels. REQUIRES: of the mask's size.
  [[nodiscard]] Mask known(Mask silhouette) const {
    return ignored ? without(std::move(silhouette), *ignored) : silhouette;
  }
};

// The weight, of 255, of a pixel of this confidence where fits compare silhouettes (CoverageLikelihood). Even the most
// doubtful pixel keeps half of its weight: a fit would otherwise move to where whole outlines are in doubt and need no
// explanation.
constexpr uint8_t pixel_weight(uint8_t confidence) { return static_cast<uint8_t>(128 + confidence / 2); }

// Errors: throws std::invalid_argument where confidence, ignored pixels or depth are not of the mask's size.
void check_sizes(const Observation& observation);

// A mask trusted less, such as one whose area jumped, would pull the track away: coasting does less harm. [guess]
inline constexpr double kLeastTrust = 0.3;

// Whether this observation, or any of several, is trusted enough to track by.
bool is_usable(const Observation& observation);
bool any_is_usable(std::span<const Observation> observations);

}  // namespace silpose
