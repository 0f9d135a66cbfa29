#include "silpose/fit/pose_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "silpose/base/check.h"
#include "silpose/base/levenberg_marquardt.h"

namespace silpose {
namespace {

constexpr SmallestGain kSmallestGain{.absolute = 0.05};  // [guess] of E

struct Point {
  Eigen::VectorXd pose;
  double energy = 0, prior_cost = 0, other_cost = 0;
  Eigen::VectorXd gradient;  // of half the whole cost
  Eigen::MatrixXd hessian;   // of half the whole cost
  [[nodiscard]] double cost() const { return energy + prior_cost + other_cost; }
};

Point evaluate(const CoverageLikelihood& likelihood, const PosePrior& pose_prior, const CoverageEvidence& evidence,
               const GaussianPrior& prior, Blur blur, Eigen::VectorXd pose, double rest_weight,
               CoverageLikelihood::Scratch& scratch) {
  Point point;
  point.pose = std::move(pose);
  NormalEquations equations = likelihood.linearise(evidence, blur, view(point.pose), scratch);
  point.energy = equations.energy;
  point.gradient = std::move(equations.gradient);
  const Eigen::VectorXd off = point.pose - prior.mean;
  const Eigen::VectorXd pull = prior.information * off;
  point.prior_cost = off.dot(pull);
  point.gradient += pull;
  point.hessian = std::move(equations.hessian);
  point.hessian += prior.information;
  point.other_cost =
      pose_prior.add(point.pose, {rest_weight, evidence.has_directions()}, point.gradient, point.hessian);
  return point;
}

// The step scaled down, as a whole, until no DOF moves by more than allowed.
void limit_step(const Skeleton& skeleton, const PoseFitOptions& options, Eigen::VectorXd& step) {
  double scale = 1;
  for (Eigen::Index d = 0; d < step.size(); ++d) {
    const double most =
        skeleton.dofs()[static_cast<size_t>(d)].is_translation ? options.max_translation : options.max_rotation;
    if (std::abs(step[d]) * scale > most) scale = most / std::abs(step[d]);
  }
  step *= scale;
}

}  // namespace

void clamp_to_limits(const Skeleton& skeleton, Eigen::VectorXd& pose) {
  for (Eigen::Index d = 0; d < pose.size(); ++d) {
    const Dof& dof = skeleton.dofs()[static_cast<size_t>(d)];
    if (dof.has_limits()) pose[d] = std::clamp(pose[d], dof.lower, dof.upper);
  }
}

PoseFit fit_pose(const CoverageLikelihood& likelihood, const PosePrior& pose_prior, const CoverageEvidence& evidence,
                 const GaussianPrior& prior, const Eigen::VectorXd& start, std::span<const FitStage> stages,
                 const PoseFitOptions& options, CoverageLikelihood::Scratch& scratch) {
  check(!stages.empty(), "fit_pose: no stage");
  const Skeleton& skeleton = likelihood.body().skeleton;
  PoseFit fit;
  Point at;
  at.pose = start;
  for (const FitStage& stage : stages) {
    at =
        evaluate(likelihood, pose_prior, evidence, prior, stage.blur, std::move(at.pose), options.rest_weight, scratch);
    levenberg_marquardt(at, stage.max_iterations, kSmallestGain, [&](const Point& from, double damping) {
      Eigen::MatrixXd damped = from.hessian;
      damped.diagonal() *= 1 + damping;
      damped.diagonal().array() += 1e-9;
      Eigen::VectorXd step = -damped.ldlt().solve(from.gradient);
      limit_step(skeleton, options, step);
      return std::optional(evaluate(likelihood, pose_prior, evidence, prior, stage.blur, from.pose + step,
                                    options.rest_weight, scratch));
    });
  }
  // Exactly inside the limits, whole turns kept: a clamped DOF moves by less than the soft limit's width.
  clamp_to_limits(skeleton, at.pose);
  fit.pose = std::move(at.pose);
  fit.energy = at.energy;
  fit.prior_cost = at.prior_cost + at.other_cost;
  fit.information = std::move(at.hessian);
  return fit;
}

}  // namespace silpose
