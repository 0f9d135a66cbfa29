#include "silpose/track/body_fit.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "silpose/base/check.h"
#include "silpose/base/levenberg.h"
#include "silpose/base/median.h"
#include "silpose/base/parallel.h"
#include "silpose/body/girth.h"
#include "silpose/body/stretchable.h"
#include "silpose/likelihood/coverage_likelihood.h"
#include "silpose/track/girth_fit.h"
#include "silpose/track/observe.h"
#include "silpose/track/plausibility.h"
#include "silpose/track/pose_fit.h"

namespace silpose {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr FitStage kStages[] = {{Blur::k8, 6}, {Blur::k4, 6}};
// How good a fit can be tells how much the silhouettes are worth, and where joints are, how thick the flesh is: each
// round starts from what the one before found out.
constexpr int kRounds = 3;
constexpr SmallestGain kSmallestGain{.relative = 1e-3};
constexpr int kVertices = 3000;        // of the mesh that is compared
constexpr double kRestWeight = 0.2;    // plausibility.h
constexpr double kMaxRotation = 0.35;  // radians a step

// The unknowns: lengths [S] of all instants, and a pose [D] each.
struct Unknowns {
  VectorXd lengths;
  std::vector<VectorXd> poses;

  // [T][D + S] poses of the stretchable body.
  [[nodiscard]] std::vector<VectorXd> stretched_poses() const {
    std::vector<VectorXd> out;
    for (const VectorXd& pose : poses) {
      out.emplace_back(pose.size() + lengths.size());
      out.back() << pose, lengths;
    }
    return out;
  }
};

// The problem at some unknowns: a block for lengths, one for each pose, and what ties both.
struct Linearised {
  double cost = 0;
  VectorXd length_gradient;
  MatrixXd length_hessian;
  std::vector<VectorXd> gradient;  // [T][D]
  std::vector<MatrixXd> hessian;   // [T][D, D]
  std::vector<MatrixXd> mixed;     // [T][S, D]
};

struct Point {
  Unknowns unknowns;
  Linearised equations;
  [[nodiscard]] double cost() const { return equations.cost; }
};

class Problem {
 public:
  Problem(const CoverageLikelihood& likelihood, const Plausibility& plausibility, std::span<CoverageEvidence> evidence)
      : likelihood_(likelihood),
        plausibility_(plausibility),
        evidence_(evidence),
        information_(stretch_covariance(likelihood.body().skeleton).inverse()) {
    const std::vector<int> shape = shape_dofs(likelihood.body().skeleton);
    lower_.resize(std::ssize(shape)), upper_.resize(std::ssize(shape));
    for (Eigen::Index s = 0; s < lower_.size(); ++s) {
      const Dof& dof = likelihood.body().skeleton.dofs()[static_cast<size_t>(shape[static_cast<size_t>(s)])];
      lower_[s] = dof.lower, upper_[s] = dof.upper;
    }
  }

  // Takes each camera's noise to be the median of the instants', as they fit now.
  void estimate_noise(const Unknowns& at) {
    std::vector<std::vector<double>> found(likelihood_.cameras().size());
    CoverageLikelihood::Scratch scratch(likelihood_);
    const std::vector<VectorXd> poses = at.stretched_poses();
    for (size_t t = 0; t < poses.size(); ++t) {
      const std::vector<double> noise = likelihood_.estimate_noise(evidence_[t], view(poses[t]), scratch);
      for (size_t c = 0; c < noise.size(); ++c) {
        if (noise[c] > 0) found[c].push_back(noise[c]);
      }
    }
    std::vector<double> noise;
    for (std::vector<double>& of_camera : found) {
      if (of_camera.empty()) of_camera.push_back(CoverageLikelihood::kExactNoise);
      noise.push_back(upper_median(std::move(of_camera)));
    }
    for (CoverageEvidence& one : evidence_) one.set_noise(noise);
  }

  [[nodiscard]] Linearised linearise(const Unknowns& at, Blur blur) const {
    const size_t T = at.poses.size();
    const auto S = at.lengths.size(), D = at.poses.front().size();
    Linearised out;
    out.gradient.resize(T), out.hessian.resize(T), out.mixed.resize(T);
    std::vector<double> costs(T);
    const std::vector<VectorXd> poses = at.stretched_poses();
    std::vector<VectorXd> length_gradients(T);
    std::vector<MatrixXd> length_hessians(T);
    parallel_for(T, 1, [&](size_t begin, size_t end) {
      CoverageLikelihood::Scratch scratch(likelihood_);
      for (size_t t = begin; t < end; ++t) {
        NormalEquations equations = likelihood_.linearise(evidence_[t], blur, view(poses[t]), scratch);
        costs[t] = equations.energy + plausibility_.add(poses[t], {kRestWeight}, equations.gradient, equations.hessian);
        out.gradient[t] = equations.gradient.head(D);
        out.hessian[t] = equations.hessian.topLeftCorner(D, D);
        out.hessian[t].diagonal().array() += 1e-6;
        out.mixed[t] = equations.hessian.bottomLeftCorner(S, D);
        length_gradients[t] = equations.gradient.tail(S);
        length_hessians[t] = equations.hessian.bottomRightCorner(S, S);
      }
    });
    out.length_gradient = information_ * at.lengths;
    out.length_hessian = information_;
    out.cost = at.lengths.dot(out.length_gradient);
    for (size_t t = 0; t < T; ++t) {
      out.cost += costs[t];
      out.length_gradient += length_gradients[t];
      out.length_hessian += length_hessians[t];
    }
    return out;
  }

  // What all instants together say of the lengths, poses eliminated.
  struct Reduced {
    MatrixXd hessian;                                // [S, S]
    VectorXd gradient;                               // [S]
    std::vector<Eigen::LDLT<MatrixXd>> pose_factor;  // [T]
  };
  static Reduced reduce(const Linearised& at, double damping) {
    Reduced reduced{at.length_hessian, at.length_gradient, {}};
    reduced.hessian.diagonal() *= 1 + damping;
    for (size_t t = 0; t < at.hessian.size(); ++t) {
      MatrixXd damped = at.hessian[t];
      damped.diagonal() *= 1 + damping;
      reduced.pose_factor.emplace_back(damped);
      const MatrixXd solved = reduced.pose_factor.back().solve(at.mixed[t].transpose());  // [D, S]
      reduced.hessian -= at.mixed[t] * solved;
      reduced.gradient -= solved.transpose() * at.gradient[t];
    }
    return reduced;
  }

  [[nodiscard]] Unknowns stepped(const Unknowns& from, const Linearised& at, double damping) const {
    const Reduced reduced = reduce(at, damping);
    Unknowns to = from;
    const VectorXd longer = -reduced.hessian.ldlt().solve(reduced.gradient);
    to.lengths = (to.lengths + longer).cwiseMax(lower_).cwiseMin(upper_);
    for (size_t t = 0; t < to.poses.size(); ++t) {
      VectorXd step = -reduced.pose_factor[t].solve(at.gradient[t] + at.mixed[t].transpose() * longer);
      const double most = step.cwiseAbs().maxCoeff();
      if (most > kMaxRotation) step *= kMaxRotation / most;
      to.poses[t] += step;
    }
    return to;
  }

 private:
  const CoverageLikelihood& likelihood_;
  const Plausibility& plausibility_;
  std::span<CoverageEvidence> evidence_;  // [T]
  MatrixXd information_;                  // [S, S] of the lengths' prior
  VectorXd lower_, upper_;                // [S] limits of the lengths
};

std::optional<BodyFit> fit_size_of(const BodyModel& body, const PinholeCamera& camera,
                                   std::span<const std::vector<double>> poses) {
  BodyFit fit;
  fit.size = fit_size(body, camera, poses);
  if (!fit.size) return std::nullopt;
  BodyModel fitted = scaled(body, fit.size->factor);
  fitted.name += ",fitted";
  fitted.facts["fitted_size"] = fmt::format("{:.4f}", fit.size->factor);
  fit.body = std::make_shared<const BodyModel>(std::move(fitted));
  return fit;
}

}  // namespace

std::optional<BodyFit> fit_body(const std::shared_ptr<const BodyModel>& body, const std::vector<PinholeCamera>& cameras,
                                std::span<const ClipInstant> clip, std::span<const std::vector<double>> poses,
                                const BodyFitOptions& options, const std::function<bool()>& proceed) {
  check(poses.size() == clip.size(), "fit_body: {} poses of {} instants", poses.size(), clip.size());
  check(options.num_instants >= 1, "fit_body: from no instant");
  std::vector<size_t> usable;
  for (size_t t = 0; t < clip.size(); ++t) {
    check(poses[t].empty() || poses[t].size() == body->skeleton.dofs().size(),
          "fit_body: a pose of {} numbers for {} DOF", poses[t].size(), body->skeleton.dofs().size());
    if (!poses[t].empty() && std::ranges::count_if(clip[t].observations, has_a_say) >= 2) usable.push_back(t);
  }
  if (cameras.size() == 1) {
    return options.floor ? fit_size_of(*body, cameras.front(), poses) : std::nullopt;
  }
  if (usable.empty()) return std::nullopt;

  const BodyModel bare = stretchable(level_of_detail(*body, kVertices));
  const std::vector<int> shape = shape_dofs(bare.skeleton);
  const Girths girths_of(bare);
  const auto S = std::ssize(shape);
  Point at{{VectorXd::Zero(S), {}}, {}};
  GirthFit girths{VectorXd::Zero(std::ssize(girths_of.names())), {}};
  std::vector<size_t> chosen;
  const size_t count = std::min(options.num_instants, usable.size());
  for (size_t i = 0; i < count; ++i) {
    chosen.push_back(usable[(2 * i + 1) * usable.size() / (2 * count)]);
    const std::vector<double>& pose = poses[chosen.back()];
    at.unknowns.poses.emplace_back(Eigen::Map<const VectorXd>(pose.data(), std::ssize(pose)));
  }
  std::vector<CoverageEvidence> evidence;
  for (int round = 0; round < kRounds; ++round) {
    const auto stretched = std::make_shared<const BodyModel>(girths_of.applied(view(girths.girths)));
    const CoverageLikelihood likelihood(stretched, cameras);
    if (evidence.empty()) {
      for (const size_t t : chosen) evidence.push_back(likelihood.prepare(clip[t].observations, Blur::k8, Blur::k4));
    }
    const Plausibility plausibility(stretched, options.floor);
    Problem problem(likelihood, plausibility, evidence);
    problem.estimate_noise(at.unknowns);
    for (const FitStage& stage : kStages) {
      at.equations = problem.linearise(at.unknowns, stage.blur);
      descend(at, stage.max_iterations, kSmallestGain, [&](const Point& from, double damping) -> std::optional<Point> {
        if (proceed && !proceed()) return std::nullopt;
        Point next{problem.stepped(from.unknowns, from.equations, damping), {}};
        next.equations = problem.linearise(next.unknowns, stage.blur);
        return next;
      });
    }
    if (round + 1 < kRounds) {
      girths = fit_girths(girths_of, cameras, evidence, at.unknowns.stretched_poses(), girths.girths, proceed);
    }
  }
  BodyFit fit;
  fit.lengths.assign(at.unknowns.lengths.begin(), at.unknowns.lengths.end());
  const MatrixXd covariance = Problem::reduce(at.equations, 0).hessian.inverse();
  for (Eigen::Index s = 0; s < S; ++s) fit.deviations.push_back(std::sqrt(std::max(covariance(s, s), 0.0)));
  for (const int d : shape) fit.names.push_back(bare.skeleton.dofs()[static_cast<size_t>(d)].name);
  for (size_t g = 0; g < girths_of.names().size(); ++g) {
    const auto idx = static_cast<Eigen::Index>(g);
    fit.girths.push_back({girths_of.names()[g], girths.girths[idx], girths.deviations[idx]});
  }
  BodyModel fitted = with_lengths(Girths(*body).applied(view(girths.girths)), fit.lengths);
  fitted.name += ",fitted";
  for (size_t s = 0; s < fit.names.size(); ++s) {
    fitted.facts[fit.names[s]] = fmt::format("{:+.4f} m", fit.lengths[s]);
  }
  for (const BodyFit::Girth& girth : fit.girths) {
    fitted.facts[girth.name + "_girth"] = fmt::format("{:+.1f} %", 100 * girth.share);
  }
  fit.body = std::make_shared<const BodyModel>(std::move(fitted));
  return fit;
}

}  // namespace silpose
