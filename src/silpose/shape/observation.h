// Observation: the tracker's input from one camera at one instant: the mask of the subject and how far to trust it.
// Threads: a value.
#pragma once

#include <tuple>
#include <vector>

#include "silpose/image/keypoints3d.h"
#include "silpose/image/mask.h"
#include "silpose/image/seen_landmark.h"

namespace silpose {

struct Trust {
  double overall = 1;           // 0: ignore this frame (the tracker coasts); 1: as good as a given mask
  bool nothing_found = false;   // no blob counts
  bool touches_border = false;  // part of the subject may be outside the picture
  bool area_jumped = false;     // area changed by more than the segmenter's limit against the recent median

  static auto members(auto& t) { return std::tie(t.overall, t.nothing_found, t.touches_border, t.area_jumped); }
};

struct Observation {
  Mask mask;                  // whole image, the chosen blob
  Box box;                    // its bounding box
  ByteImage confidence = {};  // of each pixel, 255: certain; empty: certain everywhere. Only the fitted filter uses it.
  std::vector<SeenLandmark> landmarks = {};  // of the body; none from most segmenters
  Keypoints3D keypoints = {};                // the same in space; empty from most segmenters
  Trust trust;
};

}  // namespace silpose
