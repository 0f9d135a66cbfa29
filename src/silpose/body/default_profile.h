// default_profile(): the rig profile of any body, derived from its tree and its mesh.
// Threads: functions without state.
#pragma once

#include <span>

#include "silpose/body/body_model.h"

namespace silpose {

// tree_profile() of the body's skeleton. From the mesh: the silhouette's area; the limbs that end near the floor, which
// it stands on; deviations of translations in proportion to its size. From its end points: landmarks.
[[nodiscard]] RigProfile default_profile(const BodyModel& body);

// Area of the silhouettes of a posed mesh, square metres: mean of eight directions in the plane of the floor, from far
// away. To about 1 %: cells of a grid that are covered. 0: no faces. Shapes: pose [D].
[[nodiscard]] double mean_silhouette_area(const BodyModel& body, std::span<const double> pose);

}  // namespace silpose
