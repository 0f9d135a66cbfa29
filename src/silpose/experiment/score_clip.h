// Scores of a run on a recorded clip against its truth: joints, or points on the subject's surface.
// Threads: functions without state; use all cores and give the same result on any number.
#pragma once

#include <span>

#include "silpose/base/result.h"
#include "silpose/body/body_model.h"
#include "silpose/experiment/recorded_clip.h"
#include "silpose/experiment/run_result.h"
#include "silpose/geometry/camera.h"
#include "silpose/offline/clip_instant.h"
#include "silpose/track/step_report.h"

namespace silpose {

// Root-aligned, a joint that is off by more than this counts as wrong for `roc_area_50mm`.
inline constexpr double kWrongMm = 50;

// Columns per frame, the same for any truth: those of evaluate/evaluation.h, knee_error_deg (mean absolute error of
// both knees' flexion, computed from hip, knee and ankle), joint_sd_mm (mean of the claimed deviations of the joints
// that the truth has, each the root of its summed variances), surface_error_mm and surface_median_mm (over the points
// of the true surface, distance to the nearest vertex of the posed body), observed_iou (of the estimate's silhouette
// with the mask that was found, first camera). Scores: the mean of each over frames and, as NAME_sd, its deviation;
// frames, frames_missing (without a pose). Against joints also lost and in_basin (score_parts.h), worst_frame_mm (the
// largest joint_error_root_mm), and of what is claimed, root-aligned, over all frames and joints:
//   coverage_joint, coverage_knee  share of coordinates, and of knee flexions by *_shin_rx, inside the 90 % interval
//   ece_joint                      evaluate/uncertainty.h, over coordinates
//   rank_correlation               of a joint's claimed deviation with its error
//   roc_area_50mm                  of that deviation for joints off by more than kWrongMm
//   risk_100_mm, 80, 60, 40        joint_error_root_mm over that percentage of frames, the most certain by joint_sd_mm
// Claimed deviations of joints are those of their places relative to the root joint. Against surfaces only the frames
// that have one count. Errors: those of evaluate_frames(). REQUIRES: a report; a camera.
Result<RunResult> score_clip(const ClipTruth& truth, const BodyModel& body, std::span<const PinholeCamera> cameras,
                             std::span<const StepReport> reports);

// The same columns for the keypoints that the network found in the first camera's images: turned into the world's
// axes, the middle of the hips at the world's origin, so that joint_error_mm is absent; joint_error_px is of its
// landmarks in the image. Nothing is claimed. Errors: as score_clip(); a truth of surfaces. REQUIRES: an instant.
Result<RunResult> score_keypoints(const ClipTruth& truth, const BodyModel& body, const PinholeCamera& camera,
                                  std::span<const ClipInstant> clip);

}  // namespace silpose
