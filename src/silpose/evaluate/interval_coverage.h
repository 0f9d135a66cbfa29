// Interval coverage: whether a claimed spread is calibrated. The share of frames in which the truth lies inside the
// interval that the tracker claims. A Gaussian's 90 % interval is the estimate and 1.645 spreads either way.
// Threads: pure functions.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "silpose/body/skeleton.h"

namespace silpose {

inline constexpr double kSpreadsOf90Percent = 1.645;

// Estimate minus truth, natural units [D]; periodic DOF differ by at most half a turn.
// Errors: throws std::invalid_argument on other sizes.
std::vector<double> pose_difference(const Skeleton& skeleton, std::span<const double> pose,
                                    std::span<const double> truth);

// Shapes: errors and claimed standard deviations [T, K]; [K] the share of frames with |error| <= spreads x deviation.
// An error that is rounding alone (1e-9) is inside whatever is claimed. Errors: throws std::invalid_argument for
// unequal shapes or no frame.
std::vector<double> interval_coverage(const Eigen::MatrixXd& errors, const Eigen::MatrixXd& deviations,
                                      double spreads = kSpreadsOf90Percent);

}  // namespace silpose
