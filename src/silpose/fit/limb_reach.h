// Reaching with a limb: the angles that bring its joints and its end to target positions.
// Based on: inverse kinematics by damped Gauss-Newton (references.bib: nocedal2006).
// Threads: functions without state.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "silpose/body/body_model.h"

namespace silpose {

// An end of a limb's segment.
struct LimbPoint {
  int joint_idx;
  Eigen::Vector3d offset;  // in the joint
};

// From the limb's first joint that turns outwards: joint centres, then the end point of the last joint, or the joint
// that comes after it.
std::vector<LimbPoint> limb_points(const BodyModel& body, const Limb& limb);

// Where they are in a pose [D], world.
std::vector<Eigen::Vector3d> positions(const Skeleton& skeleton, std::span<const LimbPoint> points,
                                       std::span<const double> pose);

// Moves the limb's DOF so that its points, but for the first, come nearest to `targets` (one per point), starting from
// `pose` [D] and within the limits. Only what `seen` leaves of a distance counts. Returns the largest distance left.
double reach_for(const Skeleton& skeleton, const Limb& limb, std::span<const LimbPoint> points,
                 std::span<const Eigen::Vector3d> targets, const Eigen::Matrix3d& seen, std::vector<double>& pose);

}  // namespace silpose
