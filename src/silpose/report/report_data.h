// The numbers of a report's page as JSON. Series over time are whole multiples of a step, stored as differences, so
// that ten minutes stay small: {"step": s, "deltas": [null, 3005, -2]} is [unknown, 3005 s, 3003 s]. Null is a gap,
// which the next difference skips; a value is off by half a step at most. NaN is never written. Threads: a pure
// function.
#pragma once

#include <string>

#include "silpose/report/report_input.h"

namespace silpose {

// Steps of the series.
inline constexpr double kAngleStepDeg = 0.01;
inline constexpr double kLengthStepM = 0.0001;   // translations
inline constexpr double kStepOfIntervals = 10;   // of claimed intervals, over that of their angle or length
inline constexpr double kPositionStepM = 0.001;  // of joints, for the eye

// One object: fps, facts, mask_facts, strips, downloads, warnings, stages, and for the T steps: state (a letter each:
// w waiting, i initialised, t tracked, c coasted), frame, time, accuracy and n_eff (gaps where nothing was compared),
// trust by camera, dofs (name, group, side, unit, limits, values, half: half the width of the claimed 90 % interval),
// skeleton (names, parents, positions [J + E][3] in metres), viewpoint. REQUIRES: recording and body.
std::string report_json(const ReportInput& input);

}  // namespace silpose
