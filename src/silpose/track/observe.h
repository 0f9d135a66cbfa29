// From segmentations to the tracker's observations.
// Threads: functions without state.
#pragma once

#include <span>

#include "silpose/body/body_model.h"
#include "silpose/geometry/camera.h"
#include "silpose/render/silhouette.h"
#include "silpose/segment/segmenter.h"
#include "silpose/shape/observation.h"

namespace silpose {

// The mask with its bounding box and trust.
Observation observation_from(Segmentation segmentation);

// A mask trusted less, such as one whose area jumped, would pull the track away: coasting does less harm.
inline constexpr double kLeastTrust = 0.3;

// Whether any camera saw something that is trusted enough for tracking.
bool is_usable(const Observation& observation);
bool any_is_usable(std::span<const Observation> observations);

// Intersection over union of a pose's silhouette and the mask of the first camera that found something; 0 without one.
// Shapes: one renderer of the body and one observation per camera.
double visual_accuracy(std::span<const BatchRenderer> renderers, std::span<const Observation> observations,
                       std::span<const double> pose);

}  // namespace silpose
