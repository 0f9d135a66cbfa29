#include "silpose/offline/girth_fit.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>

#include "silpose/base/check.h"
#include "silpose/base/parallel.h"
#include "silpose/fit/pose_fit.h"

namespace silpose {
namespace {

using Eigen::VectorXd;

// [guess] Sweeps over all girths; the change that is tried first and the largest change of one step, both as shares of
// the girth; the blur.
constexpr int kSweeps = 2;
constexpr double kProbe = 0.04, kLongestStep = 0.1;
constexpr Blur kBlur = Blur::k4;

class Cost {
 public:
  Cost(const Girths& girths, const std::vector<PinholeCamera>& cameras, std::span<const CoverageEvidence> evidence,
       std::span<const VectorXd> poses)
      : of_body_(girths),
        cameras_(cameras),
        evidence_(evidence),
        poses_(poses),
        information_(girths.covariance().inverse()) {}

  [[nodiscard]] double operator()(const VectorXd& girths) const {
    const auto shaped = std::make_shared<const BodyModel>(of_body_.applied(view(girths)));
    const CoverageLikelihood likelihood(shaped, cameras_);
    std::vector<double> energies(poses_.size());
    parallel_for(poses_.size(), 1, [&](size_t begin, size_t end) {
      CoverageLikelihood::Scratch scratch(likelihood);
      for (size_t t = begin; t < end; ++t) {
        energies[t] = likelihood.energy(evidence_[t], kBlur, view(poses_[t]), scratch);
      }
    });
    double cost = girths.dot(information_ * girths);
    for (const double energy : energies) cost += energy;
    return cost;
  }

 private:
  const Girths& of_body_;
  const std::vector<PinholeCamera>& cameras_;
  std::span<const CoverageEvidence> evidence_;
  std::span<const VectorXd> poses_;
  Eigen::MatrixXd information_;
};

}  // namespace

GirthFit fit_girths(const Girths& girths, const std::vector<PinholeCamera>& cameras,
                    std::span<const CoverageEvidence> evidence, std::span<const VectorXd> poses, const VectorXd& start,
                    const std::function<bool()>& proceed) {
  check(evidence.size() == poses.size(), "fit_girths: {} poses of {} instants", poses.size(), evidence.size());
  const Cost cost(girths, cameras, evidence, poses);
  GirthFit fit{start, VectorXd::Zero(start.size())};
  double here = cost(fit.girths);
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (Eigen::Index g = 0; g < start.size(); ++g) {
      if (proceed && !proceed()) return fit;
      const VectorXd probe = kProbe * VectorXd::Unit(start.size(), g);
      const double less = cost(fit.girths - probe), more = cost(fit.girths + probe);
      const double curvature = (less + more - 2 * here) / (kProbe * kProbe);  // cost is -2 log-likelihood
      if (curvature > 0) fit.deviations[g] = std::sqrt(2 / curvature);
      double step = curvature > 0 ? (less - more) / (2 * kProbe * curvature) : less < more ? -kProbe : kProbe;
      step = std::clamp(step, -kLongestStep, kLongestStep);
      VectorXd next = fit.girths;
      next[g] += step;
      if (const double there = cost(next); there < here) fit.girths = next, here = there;
    }
  }
  return fit;
}

}  // namespace silpose
