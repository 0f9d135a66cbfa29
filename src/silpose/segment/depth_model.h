// What is nearer than the scene behind it, from depth images: the farthest depth seen at a pixel over the clip is the
// background. Based on: a depth threshold (references.bib: shotton2013), here one per pixel that grows with the
// sensor's noise (references.bib: khoshelham2012). Threads: functions without state.
#pragma once

#include <span>

#include "silpose/image/image_file.h"
#include "silpose/image/mask.h"

namespace silpose {

struct DepthRange {
  double min_m = 0, max_m = 0;
};

// [H, W] mm: at each pixel the farthest known depth except one in twenty, so that the subject may be there for most of
// the clip; 65535, farther than all, where less than half are known. REQUIRES: at least one image, equal sizes.
DepthImage learn_depth_background(std::span<const DepthImage> images);

// [H, W] set where the depth is known and nearer than the background by more than noise. REQUIRES: equal sizes.
Mask nearer_than_background(const DepthImage& depth, const DepthImage& background);

// [H, W] Log odds that the subject is there, from a pixel's depth against the background's and its noise. 0 where it is
// unknown. REQUIRES: equal sizes.
Image<float> depth_evidence(const DepthImage& depth, const DepthImage& background);

// [H, W] set where the depth lies in the range, ends included.
Mask within_depth_range(const DepthImage& depth, const DepthRange& range);

}  // namespace silpose
