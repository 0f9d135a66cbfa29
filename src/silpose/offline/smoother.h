// smooth_poses(): fits the poses of a whole clip at once. Each must fit its silhouettes, and together they must move
// smoothly. Least squares over all frames, from wide blur to narrow. It refines a path, and cannot leave a wrong basin.
// Based on: Gauss-Newton with a block-banded normal matrix; marginal covariances by the block form of the Takahashi
// recursion (references.bib: nocedal2006, takahashi1973).
// Threads: a function without state; uses all cores and gives the same result on any number.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "silpose/fit/pose_fit.h"
#include "silpose/fit/pose_prior.h"
#include "silpose/likelihood/coverage_likelihood.h"
#include "silpose/offline/clip_instant.h"

namespace silpose {

struct SmootherOptions {
  std::vector<FitStage> stages = {{Blur::k8, 4}, {Blur::k4, 4}, {Blur::k2, 4}};
  double acceleration = 1.25;  // times the profile's
  double rest_weight = 0.05;   // pose_prior.h: of one frame, of some twenty a second that say the same
  EvidenceKind evidence = EvidenceKind::kSilhouette;
  std::vector<double> noise;  // [C] of the outlines, in units of pixel_unit^3; empty: that of exact masks. The last of
                              // several stages finds its own, from what the others left
};

struct SmoothedPoses {
  std::vector<Eigen::VectorXd> poses;        // [T] of [D], within the limits
  std::vector<Eigen::MatrixXd> covariances;  // [T] of [D, D]
  std::vector<double> noise;                 // [C] as taken at the last stage
  double cost = 0;                           // at the last stage
};

// Shapes: poses [T][D], an instant each. An instant of which `seen` [T] is false is bridged by motion alone. Whole
// turns of periodic DOF are kept from one pose to the next. `proceed` is asked between iterations; false ends early.
SmoothedPoses smooth_poses(const CoverageLikelihood& likelihood, const PosePrior& pose_prior,
                           std::span<const ClipInstant* const> clip, const std::vector<bool>& seen,
                           std::vector<Eigen::VectorXd> poses, const SmootherOptions& options,
                           const std::function<bool()>& proceed = {});

}  // namespace silpose
