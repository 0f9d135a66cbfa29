// PoseLikelihood: how well poses explain what cameras saw. A filter weighs its candidates by it. Silhouettes
// (silhouette_likelihood.h, coverage_likelihood.h), keypoints and depth are such likelihoods, a sum of some is one
// (sum_likelihood.h), and a program may add its own (TrackerOptions::likelihoods).
//
// Contract: log-likelihoods are finite or minus infinity, up to a constant that is the same for every pose. A pose's
// value depends neither on the rest of the batch nor on the number of threads. An observation that found nothing adds
// nothing.
// Threads: constant after construction; any thread may call.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <stdexcept>

#include "silpose/body/body_model.h"
#include "silpose/filter/state_batch.h"
#include "silpose/geometry/camera.h"
#include "silpose/image/observation.h"

namespace silpose {

// E = -2 log-likelihood and its Gauss-Newton model: E(pose + d) = energy + 2 gradient . d + d' hessian d.
struct NormalEquations {
  double energy = 0;
  Eigen::VectorXd gradient;  // [D]
  Eigen::MatrixXd hessian;   // [D, D]
};

class PoseLikelihood {
 public:
  virtual ~PoseLikelihood() = default;

  [[nodiscard]] virtual const BodyModel& body() const = 0;

  // The observations of one instant in the form that comparisons need. Shapes: one observation per camera. Instants may
  // come in any order, and several at a time; Observation::time_ns says which one it is.
  // Errors: throws std::invalid_argument where they do not fit the cameras.
  class Evidence {
   public:
    virtual ~Evidence() = default;
  };
  [[nodiscard]] virtual std::unique_ptr<const Evidence> prepare(std::span<const Observation> observations) const = 0;

  // Adds the log-likelihood of each state to `out`. Shapes: states [N, D' >= D], of which the first D columns are a
  // pose; out [N]. REQUIRES: evidence prepared by this likelihood.
  virtual void add_log_likelihood(const Evidence& evidence, const StateBatch& states, std::span<double> out) const = 0;

  // Optional: E and its Gauss-Newton model at a pose [D], which fitted filters need. E is -2 times what
  // add_log_likelihood() adds, up to a constant.
  // Errors: linearise() throws std::logic_error where can_linearise() is false.
  [[nodiscard]] virtual bool can_linearise() const { return false; }
  [[nodiscard]] virtual NormalEquations linearise(const Evidence& evidence, std::span<const double> pose) const;
};

// The evidence as the type that a likelihood prepares. Errors: throws std::invalid_argument for another's.
template <class OwnEvidence>
const OwnEvidence& own_evidence(const PoseLikelihood::Evidence& evidence) {
  if (const auto* own = dynamic_cast<const OwnEvidence*>(&evidence)) return *own;
  throw std::invalid_argument("PoseLikelihood: evidence that another likelihood prepared");
}

// Errors: throws std::invalid_argument unless there is one observation per camera; unless an observation's mask, and
// what comes with it, has its camera's size.
void check_number(std::span<const Observation> observations, size_t num_cameras);
void check_fits(const Observation& observation, const PinholeCamera& camera);

// Errors: throws std::invalid_argument unless there are N outputs for N states of at least D columns.
void check_batch(const BodyModel& body, const StateBatch& states, std::span<const double> out);

}  // namespace silpose
