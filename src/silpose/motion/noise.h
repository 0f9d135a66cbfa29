// How much a rig's degrees of freedom move at random from frame to frame: its profile's deviations, scaled.
// Threads: a function without state.
#pragma once

#include <vector>

#include "silpose/body/rig_profile.h"

namespace silpose {

// [definition] A profile's own deviation of a large joint, such as the hip.
inline constexpr double kTypicalSigmaDeg = 4;

// Standard deviation [D] of each DOF over kNoiseInterval_s, radians and metres; it grows with the square root of time.
// `sigma_deg` is that of a typical rotation: all others, translations too, scale with it.
// Errors: throws std::invalid_argument unless sigma_deg is positive and finite.
[[nodiscard]] std::vector<double> noise_deviation(const RigProfile& profile, double sigma_deg = kTypicalSigmaDeg);

}  // namespace silpose
