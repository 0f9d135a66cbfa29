// From what segment found to what the tracker is told.
// Threads: a function without state.
#pragma once

#include "silpose/segment/segmenter.h"
#include "silpose/shape/observation.h"

namespace silpose {

// The mask with its bounding box and trust.
Observation observation_from(Segmentation segmentation);

}  // namespace silpose
