// visual_accuracy(): how well a pose explains what is seen. Threads: a function without state.
#pragma once

#include <span>

#include "silpose/image/observation.h"
#include "silpose/render/silhouette.h"

namespace silpose {

// Intersection over union of a pose's silhouette and the mask of the first camera that found something, without the
// pixels that it ignores; 0 without one.
// Shapes: one renderer of the body and one observation per camera.
double visual_accuracy(std::span<const BatchRenderer> renderers, std::span<const Observation> observations,
                       std::span<const double> pose);

}  // namespace silpose
