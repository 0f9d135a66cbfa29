// Whether a background that was learned from a clip may contain the subject.
// Threads: a function without state.
#pragma once

#include <optional>

#include "silpose/image/mask.h"
#include "silpose/segment/background_model.h"

namespace silpose {

// Signs that a subject who does not move has become background, as fractions of the image or of the region.
struct BackgroundDoubt {
  double half_covered = 0;  // a quarter of the samples or more differ from the background there
  double ever_covered = 0;  // any sample does
};
BackgroundDoubt doubt_background(const BackgroundModel& model, const BackgroundSamples& samples,
                                 const std::optional<Box>& region = {});

}  // namespace silpose
