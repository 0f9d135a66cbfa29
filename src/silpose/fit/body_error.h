// BodyError: the error of an estimate because the subject's build differs from the body's.
//   - Bones may be longer or shorter (body/stretchable.h). A pose fitted with wrong lengths has the same error in all
//     frames, however well it overlaps. The noise of the outline shows how wrong the body is: nothing is added where
//     the noise is as low as exact masks of the right body leave it.
//   - One camera sees a large body far away as it sees a small one nearby. The deviation of the size is an option, and
//     is always added.
//   - Masks and networks have errors that change little from frame to frame. A filter that treats them as independent
//     claims too much accuracy. The covariance of a single frame is added, as far as the outline's noise shows that
//     neither body nor masks are exact.
// Based on: consider covariance of parameters that are not estimated (references.bib: schmidt1966).
// Threads: constant after construction; one CoverageLikelihood::Scratch of likelihood() per thread.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "silpose/fit/pose_spread.h"
#include "silpose/likelihood/coverage_likelihood.h"

namespace silpose {

class BodyError {
 public:
  // `body` is a level of detail; the stretchable one is made of it.
  // `size_deviation` is TrackerOptions'.
  BodyError(const BodyModel& body, std::vector<PinholeCamera> cameras, double size_deviation = 0);

  [[nodiscard]] const CoverageLikelihood& likelihood() const { return *likelihood_; }

  // What to add to the variance of a pose [D] that was fitted to `evidence`, prepared at Blur::k4.
  [[nodiscard]] PoseVariances variance(const CoverageEvidence& evidence, std::span<const double> pose,
                                       CoverageLikelihood::Scratch& scratch) const;

 private:
  void add_wrong_lengths(const CoverageEvidence& evidence, std::span<const double> pose,
                         CoverageLikelihood::Scratch& scratch, PoseVariances& result) const;
  [[nodiscard]] Eigen::MatrixXd correlated_errors(const CoverageEvidence& evidence, std::span<const double> stretched,
                                                  const Eigen::MatrixXd& information, const Eigen::VectorXd& rest,
                                                  CoverageLikelihood::Scratch& scratch) const;
  void add_wrong_size(const PinholeCamera& camera, std::span<const double> pose, PoseVariances& result) const;

  std::unique_ptr<CoverageLikelihood> likelihood_;  // of the stretchable body
  double size_deviation_;
  Eigen::MatrixXd lengths_;                         // [S, S] prior covariance
  std::vector<double> deviation_, seen_deviation_;  // [D] the profile's, from rest
};

}  // namespace silpose
