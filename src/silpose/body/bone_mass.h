// How a body's mass is spread: what of it is at each bone, and where. Its density is the same everywhere. A vertex is
// of the bone that has most of its weight. Threads: a function without state.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "silpose/body/body_model.h"

namespace silpose {

struct BoneMass {
  int joint_idx = 0;
  Eigen::Vector3d centre_in_joint;  // centre of mass
  double fraction = 0;              // of the whole body's mass
};

// Ordered by joint; bones without flesh are left out. From columns of the closed rest mesh, each halved between the
// bones it enters and leaves at.
[[nodiscard]] std::vector<BoneMass> bone_masses(const BodyModel& body);

}  // namespace silpose
