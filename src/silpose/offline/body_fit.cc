#include "silpose/offline/body_fit.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "silpose/base/check.h"
#include "silpose/base/levenberg_marquardt.h"
#include "silpose/base/median.h"
#include "silpose/base/parallel.h"
#include "silpose/body/girth.h"
#include "silpose/body/levels.h"
#include "silpose/body/stretchable.h"
#include "silpose/fit/pose_fit.h"
#include "silpose/fit/pose_prior.h"
#include "silpose/likelihood/coverage_likelihood.h"
#include "silpose/offline/clip_passes.h"
#include "silpose/offline/girth_fit.h"
#include "silpose/offline/judged_clip.h"
#include "silpose/track/keypoint_sides.h"

namespace silpose {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// [guess] Blur and number of steps of each stage.
constexpr FitStage kStages[] = {{Blur::k8, 6}, {Blur::k4, 6}};
// The noise of the silhouettes follows from how well they fit, and the girths from where the joints are: each round
// starts from the result of the one before. [guess]
constexpr int kRounds = 3;
constexpr SmallestGain kSmallestGain{.relative = 1e-3};
constexpr double kRestWeight = 0.2;    // [guess] RestPull::weight of one instant (pose_prior.h)
constexpr double kMaxRotation = 0.35;  // [guess] radians per step
constexpr size_t kInstants = 16;       // [guess] of the clip, evenly spread: neighbours carry the same information
// Errors of masks and networks are correlated between instants: all instants together count as this many independent
// ones.
// [tuned on simulated people] [measured: experiment human-proportions] (other people, docs/notebook/real-people.md): 4
// has the smallest errors; with 2, 8 and 16 single tracks get much worse.
constexpr double kIndependentInstants = 4;
constexpr double kStatureDeviation = 0.01;  // [guess] of a given stature, relative: shoes, posture
// Of a size by the floor, relative. [tuned on two rendered subjects, whose size was 2 % off (docs/results.md)]
constexpr double kLeastSizeDeviation = 0.02;

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
  // `information` [S, S] is that of the lengths' prior.
  Problem(const CoverageLikelihood& likelihood, const PosePrior& pose_prior, std::span<CoverageEvidence> evidence,
          MatrixXd information)
      : likelihood_(likelihood), pose_prior_(pose_prior), evidence_(evidence), information_(std::move(information)) {
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
        costs[t] = equations.energy + pose_prior_.add(poses[t], {kRestWeight}, equations.gradient, equations.hessian);
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

  // The normal equations of the lengths with poses eliminated.
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
  const PosePrior& pose_prior_;
  std::span<CoverageEvidence> evidence_;  // [T]
  MatrixXd information_;                  // [S, S] of the lengths' prior
  VectorXd lower_, upper_;                // [S] limits of the lengths
};

// Derivative of the stature by the lengths [S]. Bones of both sides are lengthened together: the longer leg stands.
VectorXd stature_by_lengths(const BodyModel& body) {
  constexpr double kLonger = 0.01;  // [guess] metres: the step of a finite difference
  const Skeleton stretched = stretchable(body).skeleton;
  const std::vector<int> shape = shape_dofs(stretched);
  const auto name = [&](size_t s) { return without_side(stretched.dofs()[static_cast<size_t>(shape[s])].name); };
  VectorXd stature(std::ssize(shape));
  for (size_t s = 0; s < shape.size(); ++s) {
    std::vector<double> lengths(shape.size(), 0.0);
    double num_lengthened = 0;
    for (size_t other = 0; other < shape.size(); ++other) {
      if (name(other) == name(s)) lengths[other] = kLonger, ++num_lengthened;
    }
    stature[static_cast<Eigen::Index>(s)] =
        (with_lengths(body, lengths).height_m - body.height_m) / (kLonger * num_lengthened);
  }
  return stature;
}

// Information [S, S] of the lengths' prior: how people differ, and with one camera the stature.
MatrixXd information_of_lengths(const BodyModel& body, bool one_camera, double size_deviation) {
  const Skeleton stretched = stretchable(body).skeleton;
  MatrixXd information = stretch_covariance(stretched).inverse();
  if (!one_camera) return information;
  const VectorXd stature = stature_by_lengths(body);
  const double deviation = body.height_m * std::hypot(kStatureDeviation, size_deviation);
  return information + stature * stature.transpose() / (deviation * deviation);
}

// Scales the body by the floor, and moves the poses so that they look the same from the camera.
std::optional<SizeFit> rescale_by_floor(BodyModel& body, const PinholeCamera& camera,
                                        std::vector<std::vector<double>>& poses) {
  const std::optional<SizeFit> size = fit_size(body, camera, poses);
  if (!size) return size;
  const Eigen::Vector3d centre = camera.centre_in_world();
  for (std::vector<double>& pose : poses) {
    if (pose.empty()) continue;
    const Eigen::Vector3d root = body.skeleton.forward_kinematics(pose).front().translation;
    place_root(body.skeleton, body.profile, pose, centre + size->factor * (root - centre));
  }
  body = scaled(body, size->factor);
  body.facts["fitted_size"] = fmt::format("{:.4f}", size->factor);
  return size;
}

// The instants that constrain lengths: seen by two cameras, or by the only one with keypoints.
std::vector<size_t> informative_instants(const JudgedClip& clip, std::span<const std::vector<double>> poses,
                                         size_t num_cameras, EvidenceKind evidence) {
  const auto is_informative = [&](size_t t) {
    const std::vector<Observation>& seen = clip[t].observations;
    if (num_cameras > 1) return std::ranges::count_if(seen, is_usable) >= 2;
    return evidence == EvidenceKind::kBoth && is_usable(seen.front()) && line_across(seen.front().keypoints_3d);
  };
  std::vector<size_t> instants;
  for (size_t t = 0; t < clip.size(); ++t) {
    if (!poses[t].empty() && is_informative(t)) instants.push_back(t);
  }
  return instants;
}

// The instants that lengths and girths are fitted to.
struct ChosenInstants {
  std::vector<const ClipInstant*> seen;  // [N]
  std::vector<VectorXd> poses;           // [N] of [D]
  // How many of them carry the same information: information of a prior is worth that much more.
  [[nodiscard]] double redundancy() const {
    return std::max(1.0, static_cast<double>(seen.size()) / kIndependentInstants);
  }
};

// Of the instants that are informative, kInstants, evenly spread.
ChosenInstants choose_instants(const JudgedClip& clip, std::span<const std::vector<double>> poses,
                               const std::vector<size_t>& informative) {
  const size_t count = std::min(kInstants, informative.size());
  ChosenInstants chosen;
  for (size_t i = 0; i < count; ++i) {
    const size_t t = informative[(2 * i + 1) * informative.size() / (2 * count)];
    chosen.seen.push_back(&clip[t]);
    chosen.poses.emplace_back(Eigen::Map<const VectorXd>(poses[t].data(), std::ssize(poses[t])));
  }
  return chosen;
}

// How a shape is fitted.
struct ShapeFitOptions {
  const std::vector<PinholeCamera>& cameras;
  EvidenceKind evidence;
  bool floor;
  MatrixXd information;  // [S, S] of the lengths' prior
  const std::function<bool()>& proceed;
};

// Lengths and poses, with the equations there, and girths.
struct ShapeFit {
  Point at;
  GirthFit girths;
};

// One round over the lengths and poses, for the girths so far.
void fit_lengths(const std::shared_ptr<const BodyModel>& stretched, const ShapeFitOptions& options,
                 const ChosenInstants& instants, std::vector<CoverageEvidence>& evidence, Point& at) {
  const CoverageLikelihood likelihood(stretched, options.cameras);
  if (evidence.empty()) {
    for (const ClipInstant* instant : instants.seen) {
      evidence.push_back(likelihood.evidence_of(instant->observations, Blur::k8, Blur::k4, options.evidence));
    }
  }
  const PosePrior pose_prior(stretched, options.floor);
  Problem problem(likelihood, pose_prior, evidence, options.information);
  problem.estimate_noise(at.unknowns);
  for (const FitStage& stage : kStages) {
    at.equations = problem.linearise(at.unknowns, stage.blur);
    levenberg_marquardt(at, stage.max_iterations, kSmallestGain,
                        [&](const Point& from, double damping) -> std::optional<Point> {
                          if (options.proceed && !options.proceed()) return std::nullopt;
                          Point next{problem.stepped(from.unknowns, from.equations, damping), {}};
                          next.equations = problem.linearise(next.unknowns, stage.blur);
                          return next;
                        });
  }
}

// Lengths and girths in turn. `girths_of` are those of the stretchable body.
ShapeFit fit_shape(const Girths& girths_of, const ShapeFitOptions& options, const ChosenInstants& instants) {
  ShapeFit fit{{{VectorXd::Zero(options.information.rows()), instants.poses}, {}},
               {VectorXd::Zero(std::ssize(girths_of.names())), {}}};
  std::vector<CoverageEvidence> evidence;
  for (int round = 0; round < kRounds; ++round) {
    const auto stretched = std::make_shared<const BodyModel>(girths_of.applied(view(fit.girths.girths)));
    fit_lengths(stretched, options, instants, evidence, fit.at);
    if (round + 1 < kRounds) {
      fit.girths = fit_girths(girths_of, options.cameras, evidence, fit.at.unknowns.stretched_poses(),
                              fit.girths.girths, options.proceed);
    }
  }
  return fit;
}

// Takes lengths and girths, with their deviations, into the result. `bare` is the stretchable body.
void take_figures(const ShapeFit& shape, const BodyModel& bare, const Girths& girths_of, double redundancy,
                  BodyFit& fit) {
  const VectorXd& lengths = shape.at.unknowns.lengths;
  fit.lengths.assign(lengths.begin(), lengths.end());
  const MatrixXd covariance = redundancy * Problem::reduce(shape.at.equations, 0).hessian.inverse();
  for (Eigen::Index s = 0; s < lengths.size(); ++s) {
    fit.deviations.push_back(std::sqrt(std::max(covariance(s, s), 0.0)));
  }
  for (const int d : shape_dofs(bare.skeleton)) {
    fit.names.push_back(bare.skeleton.dofs()[static_cast<size_t>(d)].name);
  }
  for (size_t g = 0; g < girths_of.names().size(); ++g) {
    const auto idx = static_cast<Eigen::Index>(g);
    fit.girths.push_back({girths_of.names()[g], shape.girths.girths[idx], shape.girths.deviations[idx]});
  }
}

// The body with the lengths and girths [G] of a fit, which it states among its facts.
BodyModel with_shape(const BodyModel& given, const BodyFit& fit, const VectorXd& girths) {
  BodyModel fitted = with_lengths(Girths(given).applied(view(girths)), fit.lengths);
  for (size_t s = 0; s < fit.names.size(); ++s) {
    fitted.facts[fit.names[s]] = fmt::format("{:+.4f} m", fit.lengths[s]);
  }
  for (const BodyFit::Girth& girth : fit.girths) {
    fitted.facts[girth.name + "_girth"] = fmt::format("{:+.1f} %", 100 * girth.share);
  }
  return fitted;
}

void check_poses(const BodyModel& body, size_t num_instants, std::span<const std::vector<double>> poses) {
  check(poses.size() == num_instants, "fit_body: {} poses of {} instants", poses.size(), num_instants);
  for (const std::vector<double>& pose : poses) {
    check(pose.empty() || pose.size() == body.skeleton.dofs().size(), "fit_body: a pose of {} numbers for {} DOF",
          pose.size(), body.skeleton.dofs().size());
  }
}

}  // namespace

std::optional<BodyFit> fit_body(const TrackerOptions& options, std::span<const ClipInstant> clip,
                                std::span<const std::vector<double>> poses, const std::function<bool()>& proceed) {
  check_poses(*options.body, clip.size(), poses);
  const std::vector<PinholeCamera>& cameras = options.cameras;
  const bool one_camera = cameras.size() == 1, floor = options.has_floor();
  const EvidenceKind evidence =
      options.evidence == EvidenceKind::kSilhouette ? EvidenceKind::kSilhouette : EvidenceKind::kBoth;
  const JudgedClip judged(clip, cameras.size());
  const std::vector<size_t> informative = informative_instants(judged, poses, cameras.size(), evidence);
  BodyFit fit;
  BodyModel given = *options.body;
  std::vector<std::vector<double>> given_poses(poses.begin(), poses.end());
  if (one_camera) {
    fit.size_deviation = options.size_deviation;
    if (floor && (informative.empty() || options.size_deviation > 0)) {
      fit.size = rescale_by_floor(given, cameras.front(), given_poses);
      if (fit.size) fit.size_deviation = std::max(fit.size->deviation, kLeastSizeDeviation);
    }
  }
  if (!informative.empty()) {
    const BodyModel coarse = level_of_detail(given, kBodyFitLevel);
    const BodyModel bare = stretchable(coarse);
    const Girths girths_of(bare);
    const ChosenInstants instants = choose_instants(judged, given_poses, informative);
    const double redundancy = instants.redundancy();
    const MatrixXd information = redundancy * information_of_lengths(coarse, one_camera, fit.size_deviation);
    const ShapeFit shape = fit_shape(girths_of, {cameras, evidence, floor, information, proceed}, instants);
    take_figures(shape, bare, girths_of, redundancy, fit);
    given = with_shape(given, fit, shape.girths.girths);
  } else if (!fit.size) {
    return std::nullopt;
  }
  given.name += ",fitted";
  fit.body = std::make_shared<const BodyModel>(std::move(given));
  return fit;
}

TrackerOptions options_before_fit(const TrackerOptions& options) {
  TrackerOptions pass = options_of_pass(options);
  if (options.cameras.size() == 1 && pass.fitted() != nullptr) pass.fitted()->floor = false;
  return pass;
}

std::string why_not_fitted(const TrackerOptions& options) {
  if (options.cameras.size() > 1) return "there is no frame in which two cameras see the subject";
  return options.has_floor()
             ? "no frame has 3D keypoints, and the subject does not stand on the floor y = 0 of the camera file"
             : "no frame has 3D keypoints, and no floor is known";
}

TrackerOptions options_after_fit(TrackerOptions options, const BodyFit& fit) {
  options.body = fit.body;
  options.size_deviation = fit.size_deviation;
  return options;
}

}  // namespace silpose
