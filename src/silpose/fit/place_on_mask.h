// Where a body must be to cover an observed mask.
// Threads: a function without state; uses all cores and gives the same result on any number.
#pragma once

#include "silpose/body/body_model.h"
#include "silpose/filter/state_batch.h"
#include "silpose/geometry/camera.h"
#include "silpose/image/observation.h"

namespace silpose {

// Moves each candidate's root so that its silhouette has the area and the centroid of the observed one, as far as the
// root's translations go: candidates of a rig without them come back as they are.
// Shapes: [K, D] -> [K, D]. REQUIRES: something was found.
StateBatch place_on_mask(const BodyModel& body, const PinholeCamera& camera, const Observation& observation,
                         const StateBatch& candidates);

}  // namespace silpose
