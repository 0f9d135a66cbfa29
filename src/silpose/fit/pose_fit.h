// fit_pose(): from a pose to the nearest best one: Gauss-Newton on the coverage likelihood, from wide blur to narrow,
// under a Gaussian prior and the pose prior (pose_prior.h).
// Based on: Levenberg-Marquardt (references.bib: nocedal2006); the measurement step of an iterated extended Kalman
// filter (bell1993).
// Threads: functions without state; one Scratch per thread.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "silpose/fit/pose_prior.h"
#include "silpose/likelihood/coverage_likelihood.h"

namespace silpose {

// cost(pose) = (pose - mean)' information (pose - mean). DOF of no information are free.
struct GaussianPrior {
  Eigen::VectorXd mean;         // [D]
  Eigen::MatrixXd information;  // [D, D]
};

struct FitStage {
  Blur blur = Blur::k4;
  int max_iterations = 3;
};

struct PoseFit {
  Eigen::VectorXd pose;         // [D] within the limits
  double energy = 0;            // E at the last stage's blur
  double prior_cost = 0;        // of the Gaussian prior and the pose prior
  Eigen::MatrixXd information;  // [D, D] of the silhouette, the Gaussian prior and the pose prior
  [[nodiscard]] double cost() const { return energy + prior_cost; }
};

struct PoseFitOptions {
  double max_rotation = 0.35;    // radians per step
  double max_translation = 0.3;  // metres per step
  double rest_weight = 1;        // pose_prior.h
};

// From `start` [D], stage by stage. Errors: throws std::invalid_argument without a stage.
PoseFit fit_pose(const CoverageLikelihood& likelihood, const PosePrior& pose_prior, const CoverageEvidence& evidence,
                 const GaussianPrior& prior, const Eigen::VectorXd& start, std::span<const FitStage> stages,
                 const PoseFitOptions& options, CoverageLikelihood::Scratch& scratch);

// Clamps what is limited, and keeps the whole turns of what is not: unlike Skeleton::clamp, which wraps. [D]
void clamp_to_limits(const Skeleton& skeleton, Eigen::VectorXd& pose);

// A pose [D] as the likelihoods take it.
inline std::span<const double> view(const Eigen::VectorXd& pose) {
  return {pose.data(), static_cast<size_t>(pose.size())};
}

}  // namespace silpose
