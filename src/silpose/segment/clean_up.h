// choose_blob(): of all that is foreground, the one blob that is the subject.
// Based on: 8-connected labelling. Blobs separated by no more than a small gap count as one (a belt, a strap or a dark
// edge may cut a silhouette in two).
// Threads: any thread.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "silpose/image/mask.h"

namespace silpose {

struct CleanUpOptions {
  std::optional<Box> region;         // a blob counts only if at least half of its pixels lie inside
  std::optional<Mask> garbage_mask;  // what is not set is removed, first
  int min_blob_px = -1;              // area below which a blob does not count; -1: 0.05 % of the image
  double join_gap = 0.008;           // of the image's height: gaps that do not separate blobs, and are closed
  double max_hole = 0.005;           // of the blob's area: holes up to this are filled
  int grow_px = 0;                   // last: by that many pixels; negative shrinks

  // Errors: throws std::invalid_argument where a value is out of range.
  void check() const;
};

// The largest blob that counts, whole, with parts that are close to it but separate, such as a head (4 % of its height,
// 0.5 to 30 % of its area); empty where none does. Where a silhouette is expected it is instead all blobs that count
// and lie within that, grown by kExpectedMargin of its height, for the most part: a subject who is cut in two stays
// whole, and a larger blob elsewhere is not mistaken for the subject. The expected silhouette is ignored where these
// blobs cover too little of it. Errors: throws std::invalid_argument where the garbage mask, or what is expected, has
// another size.
inline constexpr double kExpectedMargin = 0.08;  // [guess]
Mask choose_blob(const Mask& foreground, const CleanUpOptions& options, const Mask& expected = {});

// The pixels that a garbage mask removes, of which nothing is known; null where there are none.
std::shared_ptr<const Mask> removed_by(const std::optional<Mask>& garbage_mask);

// Fills holes (4-connected, not touching the border) of at most max_area pixels.
Mask fill_holes(const Mask& mask, int64_t max_area);

// Grown by a disc of radius_px; shrunk where negative (the image's border does not shrink it).
Mask grow(const Mask& mask, int radius_px);

}  // namespace silpose
