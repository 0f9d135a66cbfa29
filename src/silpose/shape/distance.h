// Distances between silhouettes. Pixel count: the number of pixels in which two masks differ, on whole images or on
// normalised silhouettes alike. Depth SSD: how far two depth images are apart.
// Source: thesis equation 2.4 (references.bib: cormier2019).
// Threads: pure functions.
#pragma once

#include <cstdint>

#include "silpose/image/image.h"
#include "silpose/image/mask.h"

namespace silpose {

// Number of differing pixels (thesis equation 2.4). REQUIRES: equal sizes.
[[nodiscard]] int64_t pixel_count_distance(const Mask& a, const Mask& b);

// The same as a fraction of both areas together: 0 for equal masks, 1 for disjoint ones; 0 when both are empty.
// REQUIRES: equal sizes.
[[nodiscard]] double pixel_count_fraction(const Mask& a, const Mask& b);

// The fraction from counts alone, as the batch renderer gives them: areas of model and observation, pixels in both.
[[nodiscard]] double pixel_count_fraction(int64_t model, int64_t observed, int64_t both);

// Depth: the sum of squared differences of two depth images in metres, 0 where nothing was seen (thesis equation 2.12);
// a pixel that shows a surface in one of them only counts `missing_m` squared. Square metres.
// REQUIRES: one channel, equal sizes.
[[nodiscard]] double depth_ssd(const Image<float>& a, const Image<float>& b, double missing_m);

}  // namespace silpose
