// Girths: the flesh around each bone a little thicker or thinner than the body's builder said. Bones that are alike
// share one (both thighs: "thigh"). Threads: functions without state.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "silpose/body/body_model.h"

namespace silpose {

// [G] the groups of bones that have flesh, in joint order, named without their side.
[[nodiscard]] std::vector<std::string> girth_names(const BodyModel& body);

// Prior covariance [G, G] of girths: of the whole body's, and of each group's beside it.
[[nodiscard]] Eigen::MatrixXd girth_covariance(size_t num_girths);

// The body whose flesh reaches further from each bone's middle line by `girths` [G], shares: 0.1 is a tenth thicker.
// Joints stay where they are; the mass follows the volume. Errors: throws std::invalid_argument for another number of
// girths, or one of -1 and below.
[[nodiscard]] BodyModel with_girths(const BodyModel& body, std::span<const double> girths);

}  // namespace silpose
