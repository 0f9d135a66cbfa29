// The PoseFilter that a tracker's options ask for: fitted hypotheses, or one or two sampling filters.
// Threads: a function without state.
#pragma once

#include <memory>
#include <vector>

#include "silpose/fit/pose_prior.h"
#include "silpose/likelihood/coverage_likelihood.h"
#include "silpose/render/silhouette.h"
#include "silpose/track/pose_filter.h"
#include "silpose/track/tracker_options.h"

namespace silpose {

// What filters compare with: renderers of the tracker's level of detail, one per camera, for those that sample; a fine
// and a coarse mesh for those that fit, and the priors that these use. All of the same body in front of the same
// cameras.
struct Likelihoods {
  std::vector<std::shared_ptr<const BatchRenderer>> renderers;
  std::shared_ptr<const CoverageLikelihood> fine, coarse;
  std::shared_ptr<const PosePrior> pose_prior;
};

// The filter of `options`. It shares the body and the likelihoods and copies what else it needs:
// neither argument has to outlive it.
// Errors: throws std::invalid_argument as TrackerOptions::check().
std::unique_ptr<PoseFilter> make_pose_filter(const TrackerOptions& options, const Likelihoods& likelihoods);

}  // namespace silpose
