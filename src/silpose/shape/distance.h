// How far two depth images are apart.
// Source: thesis equation 2.12 (references.bib: cormier2019).
// Threads: a pure function.
#pragma once

#include "silpose/image/image.h"

namespace silpose {

// The sum of squared differences of two depth images in metres, 0 where nothing was seen; a pixel that shows a surface
// in one of them only counts `missing_m` squared. Square metres.
// REQUIRES: one channel, equal sizes.
[[nodiscard]] double depth_ssd(const Image<float>& a, const Image<float>& b, double missing_m);

}  // namespace silpose
