// The PoseFilter that a tracker's options ask for: fitted hypotheses, or one or two sampling filters.
// Threads: a function without state.
#pragma once

#include <memory>

#include "silpose/fit/pose_prior.h"
#include "silpose/likelihood/coverage_likelihood.h"
#include "silpose/track/pose_filter.h"
#include "silpose/track/tracker_options.h"

namespace silpose {

// What a tracker's starts and its filter share; nothing is null.
struct TrackedBody {
  // Meshes: by the fine one poses are compared, by the coarse one candidates are ranked.
  std::shared_ptr<const BodyModel> fine, coarse;
  std::shared_ptr<const CoverageLikelihood> likelihood;  // of the fine one, before the options' cameras
  std::shared_ptr<const PosePrior> pose_prior;
};

// The filter of `options`. It shares what `body` points to and copies what else it needs: neither argument has to
// outlive it.
// Errors: throws std::invalid_argument as TrackerOptions::check().
std::unique_ptr<PoseFilter> make_pose_filter(const TrackerOptions& options, const TrackedBody& body);

}  // namespace silpose
