// ClipInstant: one instant of a recorded clip. A value.
#pragma once

#include <cstdint>
#include <vector>

#include "silpose/image/observation.h"

namespace silpose {

// What was seen at one instant: one observation per camera.
struct ClipInstant {
  int64_t frame_idx = 0;
  int64_t time_ns = 0;
  std::vector<Observation> observations;  // [C]
};

}  // namespace silpose
