// The fast renderer against the plain one, pixel by pixel: a precondition of every timing.
// Threads: one at a time; works on all cores.
#pragma once

#include <memory>

#include "silpose/body/body_model.h"

namespace silpose::bench {

// How many pixels differ, of how many that the plain renderer sets.
struct Agreement {
  long long pixels = 0;
  long long from_pixels = 0;  // from the same projected vertices, the worst of all instruction sets: none may
  long long from_poses = 0;   // from the same poses
};

// Random poses seen by four cameras, 128x128.
Agreement measure_agreement(const std::shared_ptr<const BodyModel>& body, size_t num_poses);

}  // namespace silpose::bench
