// Initialisation: from one mask and a set of common poses to ranked starting poses, by placing each on the mask and
// climbing the likelihood from there: by its derivative first, then by an adaptive search about the best.
// Source: cormier2019 sect. 2.4.1 (gradient descent from known common poses).
// Threads: a function without state; uses all cores.
#pragma once

#include <span>
#include <vector>

#include "silpose/filter/state_batch.h"
#include "silpose/likelihood/silhouette_likelihood.h"

namespace silpose {

struct InitialisationOptions {
  int num_descended_per_heading = 2;  // the best of the placed candidates that face each of eight directions
  int num_iterations = 25;            // of descent
  int num_polished = 4;               // the best of those, each facing another direction, that are searched further
  int num_particles = 200;            // of that search, a layer
  int num_layers = 20;
  double facing_bonus = 1;  // log-likelihood that facing the camera is worth; as much is lost by facing away
  uint64_t seed = 1;
};

struct StartingPose {
  std::vector<double> pose;   // [D]
  double log_likelihood = 0;
};

// Starting poses, best first: the polished ones, and the best of them with limbs exchanged between left and right and
// polished again. Their log-likelihood is without the bonus. Shapes: candidates
// [K, D]; their root translation is replaced. REQUIRES: evidence in which some camera has a say, from an
// image-comparing likelihood.
std::vector<StartingPose> initialise(const SilhouetteLikelihood& likelihood, const Evidence& evidence,
                                     const StateBatch& candidates, const InitialisationOptions& options = {});

// Moves each candidate's root so that, in the first camera that has a say, its silhouette has the area and the
// centroid of the observed one. Shapes: [K, D] -> [K, D].
StateBatch place_on_mask(const SilhouetteLikelihood& likelihood, const Evidence& evidence, const StateBatch& candidates);

}  // namespace silpose
