// Scores of one tracked sequence against its truth.
// Threads: a function without state; uses all cores and gives the same result on any number.
#pragma once

#include <span>

#include "silpose/base/result.h"
#include "silpose/body/body_model.h"
#include "silpose/experiment/run_result.h"
#include "silpose/synth/scene.h"
#include "silpose/track/step_report.h"

namespace silpose {

// Columns a frame: those of evaluate/evaluation.h over poses and joints, error_2d_px (over head top,
// shoulders, elbows, wrists, knees and ankles: cormier2019, Table 5.1) and iou of the estimate's silhouette with the
// true one in the first camera. Scores: the mean of each over frames and, as NAME_sd, its deviation; frames,
// frames_missing (without a pose), lost, in_basin (0 or 1; score_parts.h); interval_dof/COLUMN and
// interval_joint/NAME_AXIS, the share of frames inside the claimed 90 % interval, and their means coverage_dof and
// coverage_joint.
// `tracker_body` is the body that was tracked with, of the same skeleton layout as the sequence's.
// Errors: throws std::invalid_argument where reports are of frames that the sequence does not have.
Result<RunResult> score_run(const SyntheticSequence& truth, const BodyModel& tracker_body,
                            std::span<const StepReport> reports);

}  // namespace silpose
