// Flesh: the volume that a body occupies, coarsely, for any skeleton: spheres inside its skin, each fixed to a bone,
// and the points of every bone that reach furthest out. A vertex is of its main joint's bone.
// Source: largest empty balls that touch the skin (references.bib: ma2012).
// Threads: functions without state; uses all cores and gives the same result on any number.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "silpose/body/body_model.h"

namespace silpose {

struct CollisionSphere {
  int joint_idx = 0;
  Eigen::Vector3d centre_in_joint;
  double radius = 0;  // metres; no vertex of the rest mesh lies inside
};

// Ordered by joint, then by size; a few per bone. Bones without vertices have none.
[[nodiscard]] std::vector<CollisionSphere> collision_spheres(const BodyModel& body);

// [J] The middle of each bone's flesh (of the volume, in the rest pose), in its joint's frame; nothing where a bone has
// none. From columns of the closed mesh, each halved between the bones it enters and leaves at.
[[nodiscard]] std::vector<std::optional<Eigen::Vector3d>> segment_centres(const BodyModel& body);

struct SkinPoint {
  int joint_idx = 0;
  Eigen::Vector3d x_in_joint;
};

// The vertices that reach furthest along the axes of their joint, and between them; ordered by joint.
[[nodiscard]] std::vector<SkinPoint> outermost_points(const BodyModel& body);

}  // namespace silpose
