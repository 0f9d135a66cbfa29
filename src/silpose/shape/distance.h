// Distances between silhouettes. Pixel count: the number of pixels in which two masks differ, on whole images or on
// normalised silhouettes alike.
// Source: thesis equation 2.4 (references.bib: cormier2019).
// Threads: pure functions.
#pragma once

#include <cstdint>

#include "silpose/image/mask.h"

namespace silpose {

// Number of differing pixels (thesis equation 2.4). REQUIRES: equal sizes.
[[nodiscard]] int64_t pixel_count_distance(const Mask& a, const Mask& b);

// The same as a fraction of both areas together: 0 for equal masks, 1 for disjoint ones; 0 when both are empty.
// REQUIRES: equal sizes.
[[nodiscard]] double pixel_count_fraction(const Mask& a, const Mask& b);

// The fraction from counts alone, as the batch renderer gives them: areas of model and observation, pixels in both.
[[nodiscard]] double pixel_count_fraction(int64_t model, int64_t observed, int64_t both);

}  // namespace silpose
