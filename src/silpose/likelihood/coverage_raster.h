// The cells of CoverageLikelihood: how much of each an observation covers. Threads: pure functions.
#pragma once

#include "silpose/image/observation.h"
#include "silpose/likelihood/coverage_evidence.h"

namespace silpose {

// REQUIRES: cell > 0.
CoverageEvidence::Raster coverage_raster(const Observation& observation, int cell);

}  // namespace silpose
