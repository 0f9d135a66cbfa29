// The plain implementation of CoverageLikelihood::linearise(): the fast one is tested and timed against it. Every
// triangle is cut with every sampled row, the intervals of a row are united, ends are moved joint by joint, and J' K J
// is summed over all pairs of cells, in double precision. Threads: a function without state.
#pragma once

#include <span>

#include "silpose/likelihood/coverage_likelihood.h"

namespace silpose {

// The same as CoverageLikelihood(body, cameras, rows_per_cell).linearise(evidence, blur, pose), but for rounding.
// REQUIRES: evidence of these cameras.
NormalEquations linearise_reference(const BodyModel& body, std::span<const PinholeCamera> cameras,
                                    const CoverageEvidence& evidence, Blur blur, std::span<const double> pose,
                                    int rows_per_cell = 2);

}  // namespace silpose
