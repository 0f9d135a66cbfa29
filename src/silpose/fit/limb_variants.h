// Other poses that look almost the same in a silhouette: limbs reflected in depth, exchanged, or drawn at random; the
// whole body mirrored in depth.
// Based on: kinematic jump processes (references.bib: sminchisescu2003).
// Threads: functions without state.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "silpose/base/rng.h"
#include "silpose/body/body_model.h"

namespace silpose {

// The angles of two alike limbs, exchanged in a pose [D].
void exchange(std::span<double> pose, const Limb& a, const Limb& b);

// The pose with a limb's segments reflected in the planes that face `camera_centre`: first segment, the others, all of
// them. A segment ends where the next joint, or the end point, is. Only DOF of the limb change; a reflection that the
// limits do not allow to within 5 cm is left out.
std::vector<std::vector<double>> reflected_limb(const BodyModel& body, const Limb& limb, std::span<const double> pose,
                                                const Eigen::Vector3d& camera_centre);

// The pose with the limb's DOF drawn at random: near the pose, or anywhere within limits, each with probability 1/2.
std::vector<double> random_limb(const Skeleton& skeleton, const Limb& limb, std::span<const double> pose, Rng& rng);

// Another pose, and which limbs (indices) it differs in.
struct LimbVariant {
  std::vector<size_t> limbs;
  std::vector<double> pose;  // [D]
};

// All of the above for one pose: reflections of each limb, exchanges, and `num_random` random limbs, in turn, each with
// a second one besides with probability `two_at_once`.
std::vector<LimbVariant> limb_variants(const BodyModel& body, std::span<const Limb> limbs, std::span<const double> pose,
                                       const Eigen::Vector3d& camera_centre, int num_random, double two_at_once,
                                       Rng& rng);

// The pose as a mirror that faces `camera_centre` shows it, right and left relabelled: from far away its silhouette is
// the same. Nothing for a rig without a heading, or of which it is not known where it faces: its right is not the
// mirror image of its left.
std::vector<double> mirrored_in_depth(const BodyModel& body, std::span<const double> pose,
                                      const Eigen::Vector3d& camera_centre);

}  // namespace silpose
