// Poses that are far from one another and yet explain where an image shows limbs: two symmetric limbs that were
// exchanged, and a body that is turned. From an oblique view neither is found limb by limb, as everything in between
// fits worse.
// Based on: kinematic jump processes (references.bib: sminchisescu2003).
// Threads: functions without state.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "silpose/base/rng.h"
#include "silpose/body/body_model.h"

namespace silpose {

// The pose [D] with each of two alike limbs as near as it gets to where `camera_centre` sees the other; only their DOF
// change. The depth is free. Nothing where the limbs have no length, or not as many joints.
std::vector<double> exchanged_in_image(const BodyModel& body, const Limb& a, const Limb& b,
                                       std::span<const double> pose, const Eigen::Vector3d& camera_centre, Rng& rng);

// The pose [D] turned about the vertical by `angle` (radians), with limbs that stay where `camera_centre` sees them, as
// near as they get. Nothing for a rig without a heading.
std::vector<double> turned_in_image(const BodyModel& body, std::span<const double> pose, double angle,
                                    const Eigen::Vector3d& camera_centre);

// All of the above for one pose: every pair of alike limbs exchanged, and all of them at once; turned either way;
// mirrored in depth.
std::vector<std::vector<double>> depth_ambiguity_moves(const BodyModel& body, std::span<const double> pose,
                                                       const Eigen::Vector3d& camera_centre, Rng& rng);

}  // namespace silpose
