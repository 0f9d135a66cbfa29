// What scores of runs on rendered sequences and on recorded clips have in common. Private to the module `experiment`.
// Threads: functions without state.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "silpose/body/body_model.h"
#include "silpose/evaluate/evaluation.h"
#include "silpose/experiment/run_result.h"
#include "silpose/geometry/camera.h"
#include "silpose/track/step_report.h"

namespace silpose {

inline constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();

// The estimates as the tables that a result directory would hold, pixels of the camera. `time_s` of a report.
Recorded recorded_of(const BodyModel& body, const PinholeCamera& camera, std::span<const StepReport> reports,
                     const std::function<double(const StepReport&)>& time_s);

// Scores NAME and NAME_sd: a column's mean and deviation over the rows [T][columns] that have it; none where none has.
void add_mean_and_deviation(const std::string& name, const std::vector<std::vector<double>>& rows, size_t column,
                            RunResult& run);

// A run is lost when the root-aligned joint error stays above the first, mm, over this many of its last frames.
inline constexpr double kLostMm = 150;
inline constexpr int kLostFrames = 15;
// A start is in the right basin when that error is below kBasinMm at the last of this many first frames.
inline constexpr double kBasinMm = 100;
inline constexpr int kBasinFrames = 15;

// Scores lost and in_basin, by the root-aligned errors of all frames [T], mm; NaN where there is no pose.
// REQUIRES: a frame.
void add_verdicts(const std::vector<double>& root_errors, RunResult& run);

// REQUIRES: a value.
double mean_of(std::span<const double> values);

}  // namespace silpose
