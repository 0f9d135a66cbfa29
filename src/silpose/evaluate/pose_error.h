// Errors between one estimated pose and the true one: over the state's degrees of freedom, and over joints.
// Threads: pure functions.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

#include "silpose/body/skeleton.h"

namespace silpose {

// 2-norm over all DOF in normalised pose space; a periodic DOF differs by at most half its range.
// Source: cormier2019, eq. 2.10. Shapes: poses [D], natural units. Errors: throws std::invalid_argument on other sizes.
double pose_error_npsu(const Skeleton& skeleton, std::span<const double> pose, std::span<const double> truth);

// 2-norm over the rotational DOF, degrees; whole turns are no difference. Source: cormier2019, section 4.1.
double pose_error_deg(const Skeleton& skeleton, std::span<const double> pose, std::span<const double> truth);

// Mean absolute difference over the rotational DOF, degrees; whole turns are no difference.
double angle_error_deg(const Skeleton& skeleton, std::span<const double> pose, std::span<const double> truth);

// Mean Euclidean distance between points [3, K] or [2, K] that belong together. REQUIRES: K > 0, equal shapes.
double mean_distance(const Eigen::MatrixXd& points, const Eigen::MatrixXd& truth);

// The same after the similarity (rotation, scale, translation) that brings `points` [3, K] nearest to `truth`.
// Nothing when K < 3 or either set has no extent. Source: umeyama1991.
std::optional<double> aligned_distance(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& truth);

// How far a joint is bent, degrees: 180 minus the angle between the directions to its two neighbours (knee: hip and
// ankle); 0 where the three lie on a line. Nothing where two of them are in one place.
std::optional<double> flexion_deg(const Eigen::Vector3d& above, const Eigen::Vector3d& joint,
                                  const Eigen::Vector3d& below);

}  // namespace silpose
