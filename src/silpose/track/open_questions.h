// What a track leaves open, in words: joints whose angles are doubtful for a while, frames in which the network took
// left for right, and where a second pose that faces elsewhere, or has its legs exchanged, is about equally likely.
// Threads: functions without state.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "silpose/body/body_model.h"
#include "silpose/track/step_report.h"

namespace silpose {

// [guess] An angle is doubtful where half of its claimed 90 % interval is wider than kDoubtful_deg. A second pose
// leaves a question open where its weight is above kOpenWeight. Angles that are doubtful for less than kShortest_s are
// left out.
inline constexpr double kDoubtful_deg = 30, kOpenWeight = 0.15, kShortest_s = 0.25;

// "right_shin 3.1-4.0 s: within 35 degrees", the widest first, at most `most`: of the joints between the bones of limbs
// in pairs, or, for other rigs, of all that turn; twists about a bone are left out.
std::vector<std::string> doubtful_angles(std::span<const StepReport> reports, const BodyModel& body, size_t most = 6);

// One line for each kind of ambiguity: which frames, and what was done about it.
std::vector<std::string> ambiguities(std::span<const StepReport> reports);

}  // namespace silpose
