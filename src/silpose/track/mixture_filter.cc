#include "silpose/track/mixture_filter.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "silpose/base/check.h"
#include "silpose/base/parallel.h"

namespace silpose {
namespace {

// [guess] How well a starting pose is known, and how fast a body may be moving when it is first seen.
constexpr double kStartAngle = 0.15, kStartMetres = 0.05;  // radians, metres
constexpr double kStartTurn = 2.0, kStartSpeed = 1.0;      // per second
// [guess] A limb that jumped may be anywhere near where it landed.
constexpr double kJumpAngle = 0.5, kJumpTurn = 3.0;
constexpr double kCoastDecay_per_s = 3;  // unseen, a body is assumed to slow down
// [guess] Blur and number of steps of each stage.
constexpr FitStage kTrackingStages[] = {{Blur::k8, 4}, {Blur::k4, 3}, {Blur::k2, 3}};
constexpr FitStage kJumpStages[] = {{Blur::k8, 2}, {Blur::k4, 3}, {Blur::k2, 3}};

GaussianPrior prior_of(const GaussianComponent& component) {
  const Eigen::Index D = component.num_dofs();
  return {component.pose(), component.pose_covariance().ldlt().solve(Eigen::MatrixXd::Identity(D, D))};
}

double log_determinant(const Eigen::MatrixXd& positive) {
  return positive.ldlt().vectorD().array().abs().max(1e-300).log().sum();
}

}  // namespace

struct MixtureFilter::Child {
  GaussianComponent component;  // predicted, with the limb that jumped set free; then conditioned
  GaussianPrior prior;
  Eigen::VectorXd start;  // of the fit
  PoseFit fit;
  double log_weight = 0;  // before this step's evidence
};

MixtureFilter::MixtureFilter(std::shared_ptr<const CoverageLikelihood> fine,
                             std::shared_ptr<const CoverageLikelihood> coarse,
                             std::shared_ptr<const PosePrior> pose_prior, const MixtureOptions& options)
    : fine_(std::move(fine)), coarse_(std::move(coarse)), pose_prior_(std::move(pose_prior)), options_(options) {
  check(fine_ && coarse_ && pose_prior_, "MixtureFilter: no likelihood, or no pose_prior");
  check(options.num_hypotheses >= 1, "MixtureFilter: {} hypotheses", options.num_hypotheses);
  limbs_ = fine_->body().profile.limbs;
  acceleration_ = fine_->body().profile.acceleration;
  for (double& deviation : acceleration_) deviation *= options.acceleration;
}

GaussianComponent MixtureFilter::component_of(const Eigen::VectorXd& pose, double log_weight) const {
  std::vector<double> deviation, speed;
  for (const Dof& dof : fine_->body().skeleton.dofs()) {
    deviation.push_back(dof.is_translation ? kStartMetres : kStartAngle);
    speed.push_back(dof.is_translation || dof.joint_idx == 0 ? kStartSpeed : kStartTurn);
  }
  GaussianComponent component = component_at(view(pose), deviation, speed);
  component.log_weight = log_weight;
  return component;
}

void MixtureFilter::start(const std::vector<Eigen::VectorXd>& poses) {
  check(!poses.empty(), "MixtureFilter: no pose to start from");
  hypotheses_.clear();
  for (const Eigen::VectorXd& pose : poses) hypotheses_.push_back(component_of(pose, 0));
  normalise_weights(hypotheses_);
}

void MixtureFilter::add(const std::vector<Eigen::VectorXd>& poses) {
  check(!hypotheses_.empty(), "MixtureFilter: add before start");
  const GaussianComponent best = hypotheses_.front();
  const double known = log_determinant(best.pose_covariance()), log_weight = best.log_weight + options_.jump_log_prior;
  for (const Eigen::VectorXd& pose : poses) {
    GaussianComponent component = component_of(pose, log_weight);
    // To learn a pose costs evidence, which those that were there before paid when they did.
    component.log_weight += std::max(0.0, 0.5 * (log_determinant(component.pose_covariance()) - known));
    hypotheses_.push_back(std::move(component));
  }
  normalise_weights(hypotheses_);
}

void MixtureFilter::step(const CoverageEvidence& evidence, double dt_s) {
  check(!hypotheses_.empty(), "MixtureFilter: step before start");
  const PoseFitOptions fit_options{.rest_weight = options_.rest_weight};
  std::vector<Child> children(hypotheses_.size());
  const auto fit = [&](std::vector<Child>& some, std::span<const FitStage> stages) {
    parallel_for(some.size(), 1, [&](size_t begin, size_t end) {
      CoverageLikelihood::Scratch scratch(*fine_);
      for (size_t i = begin; i < end; ++i) {
        some[i].fit =
            fit_pose(*fine_, *pose_prior_, evidence, some[i].prior, some[i].start, stages, fit_options, scratch);
      }
    });
  };
  for (size_t i = 0; i < children.size(); ++i) {
    Child& child = children[i];
    child.component = hypotheses_[i];
    predict_constant_velocity(child.component, dt_s, acceleration_, kNoiseInterval_s);
    child.prior = prior_of(child.component);
    child.start = child.prior.mean;
    child.log_weight = hypotheses_[i].log_weight;
  }
  fit(children, kTrackingStages);
  std::vector<Child> jumps = jumps_from(evidence, children);
  fit(jumps, kJumpStages);
  for (Child& jump : jumps) children.push_back(std::move(jump));
  keep_best(std::move(children));
  ++steps_;
}

void MixtureFilter::coast(double dt_s) {
  for (GaussianComponent& hypothesis : hypotheses_) {
    predict_constant_velocity(hypothesis, dt_s, acceleration_, kNoiseInterval_s, kCoastDecay_per_s);
  }
  ++steps_;
}

void MixtureFilter::restore(State state) {
  const Eigen::Index size = 2 * Eigen::Index{fine_->body().skeleton.num_dofs()};
  for (const GaussianComponent& hypothesis : state.hypotheses) {
    check(
        hypothesis.mean.size() == size && hypothesis.covariance.rows() == size && hypothesis.covariance.cols() == size,
        "MixtureFilter: hypotheses of {} numbers for a body of {}", hypothesis.mean.size(), size);
  }
  hypotheses_ = std::move(state.hypotheses);
  steps_ = state.steps;
}

// Other limbs for the best of what was fitted: a limb that jumped is free to be anywhere near where it landed.
std::vector<MixtureFilter::Child> MixtureFilter::jumps_from(const CoverageEvidence& evidence,
                                                            const std::vector<Child>& fitted) const {
  std::vector<size_t> order(fitted.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::ranges::stable_sort(order, std::greater<>{},
                           [&](size_t i) { return fitted[i].log_weight - 0.5 * fitted[i].fit.cost(); });
  order.resize(std::min(order.size(), static_cast<size_t>(options_.num_parents)));

  const Eigen::Vector3d camera_centre = fine_->cameras()[evidence.first_seen().value_or(0)].centre_in_world();
  std::vector<std::vector<LimbVariant>> variants(order.size());
  parallel_for(order.size(), 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      Rng rng(options_.seed, steps_, order[i]);
      variants[i] = rank_limb_variants(*coarse_, evidence, limbs_, view(fitted[order[i]].fit.pose), camera_centre,
                                       options_.limbs, rng);
    }
  });
  std::vector<Child> jumps;
  for (size_t i = 0; i < order.size(); ++i) {
    const Child& parent = fitted[order[i]];
    for (const LimbVariant& variant : variants[i]) {
      Child child;
      child.component = parent.component;
      const Eigen::Index D = child.component.num_dofs();
      child.start = parent.fit.pose;  // whole turns and all
      for (const size_t l : variant.limbs) {
        for (const int d : limbs_[l].dofs) {
          Eigen::MatrixXd& P = child.component.covariance;
          for (const Eigen::Index k : {static_cast<Eigen::Index>(d), D + d}) {
            P.row(k).setZero();
            P.col(k).setZero();
          }
          child.start[d] = variant.pose[static_cast<size_t>(d)];
          P(d, d) = kJumpAngle * kJumpAngle;
          P(D + d, D + d) = kJumpTurn * kJumpTurn;
          child.component.mean[d] = child.start[d];
          child.component.mean[D + d] = 0;
        }
      }
      child.prior = prior_of(child.component);
      child.log_weight = parent.log_weight + options_.jump_log_prior;
      jumps.push_back(std::move(child));
    }
  }
  return jumps;
}

void MixtureFilter::keep_best(std::vector<Child> children) {
  const BodyModel& body = fine_->body();
  for (Child& child : children) {
    // The evidence by Laplace's method: likelihood and prior at the best pose, times how much of the prior is left.
    child.log_weight -=
        0.5 * (child.fit.cost() + log_determinant(child.fit.information) - log_determinant(child.prior.information));
  }
  std::ranges::stable_sort(children, std::greater<>{}, &Child::log_weight);
  std::vector<std::vector<Eigen::Vector3d>> landmarks;
  std::vector<GaussianComponent> kept;
  for (Child& child : children) {
    std::vector<Eigen::Vector3d> x = landmark_positions(body, view(child.fit.pose));
    const auto is_near = [&](const auto& other) { return furthest_apart(x, other) < options_.merge_distance; };
    if (std::ranges::any_of(landmarks, is_near)) continue;
    condition_on_pose(child.component, child.fit.pose, child.fit.information);
    child.component.log_weight = child.log_weight;
    kept.push_back(std::move(child.component));
    landmarks.push_back(std::move(x));
    if (std::ssize(kept) == options_.num_hypotheses) break;
  }
  hypotheses_ = std::move(kept);
  normalise_weights(hypotheses_);
}

}  // namespace silpose
