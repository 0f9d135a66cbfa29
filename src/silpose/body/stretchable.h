// stretchable(): a body whose bones may be a little longer or shorter than its builder said. Each long bone gets one
// more DOF, a length, after those of the pose: a pose of the body, followed by zeros, is a pose of the stretchable one.
// What is not known of a subject can then be estimated, or at least allowed for. Threads: functions without state.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "silpose/body/body_model.h"

namespace silpose {

// The lengths are named after the bone's outer joint: "right_shin_length". Metres, 0: as built; limits are three
// deviations.
BodyModel stretchable(const BodyModel& body);

// Prior covariance [S, S] of the lengths, in DOF order. Shapes: S shape DOF of a skeleton made by stretchable().
Eigen::MatrixXd stretch_covariance(const Skeleton& skeleton);

// The body whose bones are longer by `lengths` [S] metres than they were when stretchable(body) was made, in the order
// of shape_dofs(): an ordinary body of the same skeleton otherwise, for any pose of the first. Its stature changes with
// it. Errors: throws std::invalid_argument for another number of lengths, or a bone that would vanish.
BodyModel with_lengths(const BodyModel& body, std::span<const double> lengths);

// The body larger by `factor` in all directions, its mass by the cube. Errors: throws std::invalid_argument unless
// positive.
BodyModel scaled(const BodyModel& body, double factor);

// Indices of the shape DOF.
std::vector<int> shape_dofs(const Skeleton& skeleton);

}  // namespace silpose
