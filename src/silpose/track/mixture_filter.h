// MixtureFilter: a few hypotheses, each an iterated extended Kalman filter whose measurement step is a fit of the
// silhouette. They are predicted, fitted, weighed and killed as particles are; ambiguities of a silhouette (which leg
// is in front, whether a forearm points at the camera or away) give new ones.
//
// One step: predict at constant velocity; fit each hypothesis; try other limbs for the best two; weigh by evidence;
// merge those that converged; keep the best K.
// Based on: iterated extended Kalman filter (references.bib: bell1993), kinematic jumps (sminchisescu2003).
// Threads: one thread per filter; steps use all cores inside and give the same result on any number.
#pragma once

#include <memory>
#include <tuple>
#include <vector>

#include "silpose/filter/gaussian_mixture.h"
#include "silpose/fit/limb_search.h"
#include "silpose/fit/pose_fit.h"
#include "silpose/likelihood/coverage_likelihood.h"

namespace silpose {

struct MixtureOptions {
  int num_hypotheses = 4;
  int num_parents = 2;           // of new hypotheses, the best
  LimbSearchOptions limbs;       // of new hypotheses, for each parent
  double acceleration = 1.25;    // times the profile's
  double rest_weight = 1;        // pose_prior.h: holds what a silhouette does not show
  double jump_log_prior = -6;    // log-probability of a hypothesis that jumped
  double merge_distance = 0.05;  // metres: hypotheses with all joints nearer than this are merged
  uint64_t seed = 1;
};

class MixtureFilter {
 public:
  // `fine` is fitted, `coarse` ranks candidates: two meshes of the same body in front of the same cameras.
  MixtureFilter(std::shared_ptr<const CoverageLikelihood> fine, std::shared_ptr<const CoverageLikelihood> coarse,
                std::shared_ptr<const PosePrior> pose_prior, const MixtureOptions& options);

  // Starts over at poses [K][D], equally likely: the first step weighs them.
  void start(const std::vector<Eigen::VectorXd>& poses);

  // Adds hypotheses, each as likely as the jump prior says against the best there is: the next step decides.
  void add(const std::vector<Eigen::VectorXd>& poses);

  // REQUIRES: evidence prepared up to Blur::k8; dt_s >= 0 since the last call.
  void step(const CoverageEvidence& evidence, double dt_s);
  void coast(double dt_s);

  // Best first, weights normalised.
  [[nodiscard]] std::span<const GaussianComponent> hypotheses() const { return hypotheses_; }

  // State from which another filter with the same options and body continues exactly as this one would.
  // Errors: restore() throws std::invalid_argument for hypotheses of another size.
  struct State {
    std::vector<GaussianComponent> hypotheses;
    uint64_t steps = 0;
    static auto members(auto& s) { return std::tie(s.hypotheses, s.steps); }
  };
  [[nodiscard]] State state() const { return {hypotheses_, steps_}; }
  void restore(State state);

 private:
  struct Child;
  std::vector<Child> jumps_from(const CoverageEvidence& evidence, const std::vector<Child>& fitted) const;
  [[nodiscard]] GaussianComponent component_of(const Eigen::VectorXd& pose, double log_weight) const;
  void keep_best(std::vector<Child> children);

  std::shared_ptr<const CoverageLikelihood> fine_, coarse_;
  std::shared_ptr<const PosePrior> pose_prior_;
  MixtureOptions options_;
  std::vector<Limb> limbs_;
  std::vector<double> acceleration_;  // [D]
  std::vector<GaussianComponent> hypotheses_;
  uint64_t steps_ = 0;
};

}  // namespace silpose
