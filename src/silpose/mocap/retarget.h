// Retargeting: recorded motion of another skeleton (a motion-capture Clip) to poses of our human.
// Bodies differ in size, so limb directions are matched, not positions; pelvis, chest and head are matched by how they
// turn from the clip's rest pose. One damped least-squares solve per frame, started from the frame before.
// Based on: Levenberg-Marquardt with bounds by an active set (references.bib: nocedal2006).
// Threads: functions without state.
#pragma once

#include <vector>

#include "silpose/base/result.h"
#include "silpose/body/body_model.h"
#include "silpose/mocap/clip.h"

namespace silpose {

struct RetargetOptions {
  double fps = 30;  // of the poses; a clip at a whole multiple of it gives every n-th frame, others are interpolated
};

struct Retargeted {
  std::vector<std::vector<double>> poses;  // [T][D] metres, radians, inside the limits
  double fps = 30;
  // Angle between the clip's and our direction of thighs, shins, upper arms and forearms: over limbs and frames.
  double mean_residual_deg = 0, max_residual_deg = 0;
  double metres_per_unit = 0;        // of the clip: ratio of leg lengths
  bool first_frame_skipped = false;  // it was the capture's calibration pose (see below)
  bool is_z_up = false;              // the clip's world has z up
};

// Root translation is kept, scaled by the ratio of leg lengths, and lifted as a whole until the feet are on y = 0 (the
// 5th percentile over frames of the body's lowest point). The first frame is left out when it is the rest pose
// itself and the limbs jump by more than 5 degrees to the second: many CMU files open with a T-pose. A twist that limb
// directions do not show stays near zero. Errors: no frame; a joint that has no match; rest pose of no size; names what
// is missing.
Result<Retargeted> retarget(const Clip& clip, const BodyModel& body, const RetargetOptions& options = {});

}  // namespace silpose
