// How certain a segmenter is of each pixel of its mask: 255 certain, 0 not at all.
// Threads: functions without state.
#pragma once

#include "silpose/image/image.h"
#include "silpose/image/mask.h"

namespace silpose {

// The lesser of the two, pixel by pixel. REQUIRES: equal sizes.
void lower_confidence(ByteImage& confidence, const ByteImage& other);

// What a clean-up changed is not certain: holes it filled, pieces it dropped. Shapes: all [H, W].
void doubt_changes(ByteImage& confidence, const Mask& found, const Mask& cleaned);

// An edge has to be somewhere: uncertain stripes up to about 1 % of the subject's size wide are treated as a sharp edge
// and made certain, so that the remaining uncertainty is about more than the exact course of the outline. Shapes: both
// [H, W].
void forgive_edges(ByteImage& confidence, const Mask& mask);

}  // namespace silpose
