// How far degrees of freedom deviate: in one frame at 30 per second, from constant velocity, and from rest. Tables by
// DOF name for people who walk and gesture; for the DOF of other skeletons a rule from their range.
// Threads: a function without state.
#pragma once

#include <vector>

#include "silpose/body/skeleton.h"

namespace silpose {

// [definition] The interval that noise deviations are stated for; the table's own deviation of a large joint (the hip).
inline constexpr double kNoiseInterval_s = 1.0 / 30;
inline constexpr double kTypicalSigmaDeg = 4;

// Standard deviation [D] of each DOF over kNoiseInterval_s, radians and metres; it grows with the square root of time.
// `sigma_deg` is that of a typical rotation: all others, translations too, scale with it.
// Errors: throws std::invalid_argument unless sigma_deg is positive and finite.
[[nodiscard]] std::vector<double> noise_deviation(const Skeleton& skeleton, double sigma_deg = kTypicalSigmaDeg);

// Deviation [D] of the change of velocity over kNoiseInterval_s, times that interval: how far a DOF ends up from where
// constant velocity would take it. Radians and metres.
[[nodiscard]] std::vector<double> acceleration_deviation(const Skeleton& skeleton);

// Deviation [D] of poses from all joints at zero, radians; 0 for what may be anywhere: translations, headings, lengths,
// joints that turn freely. With `directions_seen` those joints are looser whose segments' directions are measured.
[[nodiscard]] std::vector<double> pose_deviation(const Skeleton& skeleton, bool directions_seen = false);

}  // namespace silpose
