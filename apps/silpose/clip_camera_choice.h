// The camera of `silpose track` without a calibration file: estimated from the clip, or assumed.
// Threads: the main thread only.
#pragma once

#include <nlohmann/json.hpp>

#include "apps/silpose/camera_choice.h"
#include "apps/silpose/console.h"
#include "silpose/base/result.h"
#include "silpose/session/observation_source.h"

namespace silpose::app {

// Puts the estimated camera, with a warning that says how well it is known, in place of the assumed one; where the clip
// shows too little of the person, the assumed one stays, and its warning says why. Errors: those of
// estimate_clip_camera(); interrupted.
Result<void> estimate_camera_of(ObservationSource& source, double body_height_m, CameraChoice& choice,
                                Console& console);

// {"focal_px": {mean, std}, "height_m": ..., "tilt_deg": ..., "roll_deg": ..., "frames": N, "body_height_m": H}
nlohmann::ordered_json facts_of(const CameraEstimate& estimate);

}  // namespace silpose::app
