// How sure a segmenter is of each pixel of its mask: 255 sure, 0 not at all.
// Threads: functions without state.
#pragma once

#include "silpose/image/image.h"
#include "silpose/image/mask.h"

namespace silpose {

// The lesser of the two, pixel by pixel. REQUIRES: equal sizes.
void lower_confidence(ByteImage& confidence, const ByteImage& other);

// What a clean-up changed is not sure: holes it filled, pieces it dropped. Shapes: all [H, W].
void doubt_changes(ByteImage& confidence, const Mask& found, const Mask& cleaned);

// An edge has to be somewhere: unsure stripes up to about 1 % of the subject's size wide are taken for a sharp edge and
// made sure, so that what is left is unsure about more than where exactly the outline runs. Shapes: both [H, W].
void forgive_edges(ByteImage& confidence, const Mask& mask);

}  // namespace silpose
