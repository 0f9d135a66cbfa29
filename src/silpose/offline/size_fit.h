// fit_size(): the size of a subject that one camera sees standing on a known floor. One camera alone cannot distinguish
// a larger body further away from a smaller one nearby: poses tracked without a floor are right up to a scaling about
// the camera's centre, and the right one has the feet on the floor. Threads: a function without state.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "silpose/body/body_model.h"
#include "silpose/geometry/camera.h"

namespace silpose {

struct SizeFit {
  double factor = 1;     // larger than the body
  double deviation = 0;  // of the factor between instants; errors of the camera file are not in it
};

// From poses [T][D] of the body, tracked without a floor; empty ones are left out. The lowest point of most of them
// must be on the floor: the subject may jump for less than half of the time. Nothing without a pose, or where the floor
// y = 0 is not below the camera and the subject.
std::optional<SizeFit> fit_size(const BodyModel& body, const PinholeCamera& camera,
                                std::span<const std::vector<double>> poses);

}  // namespace silpose
