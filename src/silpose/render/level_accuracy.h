// How much the silhouettes of a level of detail overlap with the whole body's.
// Threads: pure function; runs on all cores (base/parallel.h), the result does not depend on how many.
#pragma once

#include "silpose/body/body_model.h"

namespace silpose {

// Over random poses within the limits, seen from all around at two heights; each silhouette is drawn at `size` x `size`
// pixels, cropped to the whole body's.
struct AccuracyOptions {
  int num_poses = 100, num_views = 8;
  int size = 128;
  uint64_t seed = 1;
};
struct LevelAccuracy {
  double mean_iou = 0, worst_iou = 1;
};
// REQUIRES: at least one pose and one view.
[[nodiscard]] LevelAccuracy level_accuracy(const BodyModel& body, const BodyLevel& level,
                                           const AccuracyOptions& options = {});

}  // namespace silpose
