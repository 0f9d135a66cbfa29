// Initialisation: from one instant's masks and a set of common poses to ranked starting poses. Each candidate is placed
// on the mask and fitted from wide blur to narrow. From the best of each heading a search of its own tries other limbs,
// until one of them explains the silhouette: the initially best one often cannot be corrected limb by limb. Where none
// does, another search starts from poses that look like the best but are far from it: symmetric limbs exchanged, the
// body turned.
// Source: cormier2019 sect. 2.4.1 (gradient descent from known common poses).
// Threads: functions without state; all cores are used, and the result is the same on any number.
#pragma once

#include <span>
#include <vector>

#include "silpose/filter/state_batch.h"
#include "silpose/fit/pose_fit.h"
#include "silpose/likelihood/coverage_likelihood.h"

namespace silpose {

struct InitialisationOptions {
  int num_per_heading = 5;         // of eight: candidates that are fitted finely; as many in all without a heading
  int num_headings = 8;            // that are searched, the best first, until a start explains the silhouette
  int first_heading = 0;           // of the best, cyclic
  int num_varied = 4;              // the best of a heading, of which other limbs are tried
  int num_rounds = 8;              // of trying other limbs of a heading, at most: no progress ends them
  int patience = 3;                // rounds in a row with little progress, where the best of all headings are searched
  int num_random_limbs = 60;       // tried of each, besides reflections and exchanges
  int num_fitted = 4;              // of those of each, the most promising
  double share_fitted_finely = 1;  // of these, the better ones after a coarse fit
  int num_distant_rounds = 3;      // of poses like the best but far from it, at most: no progress ends them
  int num_starts = 8;
  double merge_distance = 0.1;  // metres: starts with all joints nearer than this are merged
  uint64_t seed = 1;
  double facing_bonus = 1;  // log-likelihood that facing the camera is worth; as much is lost by facing away
  EvidenceKind evidence = EvidenceKind::kSilhouette;  // where keypoints are used, facing is ignored
};

struct StartingPose {
  std::vector<double> pose;   // [D] within the limits
  double log_likelihood = 0;  // with the bonus
};

// Starting poses, best first; at least one. Shapes: one observation per camera; candidates [K, D], whose root
// translation is replaced. REQUIRES: an observation in which something was found.
std::vector<StartingPose> initialise(const CoverageLikelihood& likelihood, const PosePrior& pose_prior,
                                     std::span<const Observation> observations, const StateBatch& candidates,
                                     const InitialisationOptions& options = {});

}  // namespace silpose
