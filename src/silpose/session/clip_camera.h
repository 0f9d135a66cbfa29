// The camera of a clip without a calibration file, estimated from the person in it (calibrate/person_camera.h).
// Threads: a function without state.
#pragma once

#include <cstdint>
#include <optional>

#include "silpose/base/progress.h"
#include "silpose/base/result.h"
#include "silpose/calibrate/focal_prior.h"
#include "silpose/calibrate/person_camera.h"
#include "silpose/session/observation_source.h"

namespace silpose {

struct ClipCamera {
  std::optional<CameraEstimate> estimate;  // absent: the clip shows too little of the person
  int64_t num_frames = 0, num_whole = 0;   // examined, and of these showing the subject whole and upright
  bool stopped = false;                    // by the progress sink: nothing is estimated
};

// Segments some frames of the clip of one camera, which is rewound then. `body_height_m`: the subject's stature.
// Errors: those of ObservationSource.
Result<ClipCamera> estimate_clip_camera(ObservationSource& source, double body_height_m, const FocalPrior& focal,
                                        ProgressSink* progress = nullptr);

}  // namespace silpose
