// The reports of a clip that was smoothed.
// Threads: functions without state; use all cores and give the same result on any number.
#pragma once

#include <span>
#include <vector>

#include "silpose/offline/clip_evidence.h"
#include "silpose/offline/clip_hypotheses.h"
#include "silpose/offline/judged_clip.h"
#include "silpose/offline/smoother.h"
#include "silpose/track/step_report.h"
#include "silpose/track/tracker_options.h"

namespace silpose {

// Reports [T] that say what was observed, and no pose: State::kWaiting.
std::vector<StepReport> waiting_reports(const JudgedClip& clip);

// What smoothed instants [N] are reported from.
struct SmoothedClip {
  const ClipEvidence& evidence;                   // [N], with the noise that smoothing found
  const SmoothedPoses& smoothed;                  // [N]
  std::span<const Hypotheses> hypotheses;         // [N] of all passes
  std::span<const std::vector<double>> energies;  // [N][K] of these
};

// Fills in poses, spreads, states and overlap of reports [N] of these instants. The spread is the covariance of the
// fit, what the passes disagree about (clip_spread.h), and the error of the body (body_error.h).
void report_smoothed(const TrackerOptions& options, const SmoothedClip& clip, std::span<StepReport> reports);

}  // namespace silpose
