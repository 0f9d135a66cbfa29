// rank_limb_variants(): of all poses that differ from one in a limb (limb_variants.h), the few that are worth a fit.
// Threads: a function without state; uses all cores and gives the same result on any number.
#pragma once

#include <span>
#include <vector>

#include "silpose/fit/limb_variants.h"
#include "silpose/likelihood/coverage_likelihood.h"

namespace silpose {

struct LimbSearchOptions {
  int num_random = 40;  // random limbs, besides reflections and exchanges
  int num_kept = 3;
  double novelty = 0.12;   // metres: in some joint as far at least from the pose, and from each other
  double two_at_once = 0;  // share of the random limbs to which a second one is added
};

// Best first by one evaluation at Blur::k4. Shapes: pose [D]; limbs of the likelihood's body. `camera_centre`: where
// the camera is.
std::vector<LimbVariant> rank_limb_variants(const CoverageLikelihood& likelihood, const CoverageEvidence& evidence,
                                            std::span<const Limb> limbs, std::span<const double> pose,
                                            const Eigen::Vector3d& camera_centre, const LimbSearchOptions& options,
                                            Rng& rng);

}  // namespace silpose
