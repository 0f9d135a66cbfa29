// The camera of a clip that has no calibration file, estimated from the person in it (calibrate/person_camera.h).
// Threads: the main thread only.
#pragma once

#include <nlohmann/json.hpp>

#include "apps/silpose/camera_choice.h"
#include "apps/silpose/console.h"
#include "apps/silpose/observation_source.h"
#include "silpose/base/result.h"

namespace silpose::app {

// Masks some frames of the clip, which is rewound then, and puts the estimated camera, with a warning that says how
// well it is known, in place of the assumed one; where the clip shows too little of the person, the assumed one stays,
// and its warning says why. Errors: those of ObservationSource; interrupted.
Result<void> estimate_camera_of(ObservationSource& source, double body_height_m, CameraChoice& choice,
                                Console& console);

// {"focal_px": {mean, std}, "height_m": ..., "tilt_deg": ..., "roll_deg": ..., "frames": N, "body_height_m": H}
nlohmann::ordered_json facts_of(const CameraEstimate& estimate);

}  // namespace silpose::app
