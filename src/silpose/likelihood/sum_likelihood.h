// SumLikelihood: several likelihoods as one, for kinds of evidence that are independent given the pose.
// Threads: as PoseLikelihood.
#pragma once

#include <memory>
#include <vector>

#include "silpose/likelihood/pose_likelihood.h"

namespace silpose {

class SumLikelihood final : public PoseLikelihood {
 public:
  // REQUIRES: at least one part, all of bodies with the same degrees of freedom.
  explicit SumLikelihood(std::vector<std::shared_ptr<const PoseLikelihood>> parts);

  [[nodiscard]] const BodyModel& body() const override { return parts_.front()->body(); }
  [[nodiscard]] std::unique_ptr<const Evidence> prepare(std::span<const Observation> observations) const override;
  void add_log_likelihood(const Evidence& evidence, const StateBatch& states, std::span<double> out) const override;
  // Where every part can.
  [[nodiscard]] bool can_linearise() const override;
  [[nodiscard]] NormalEquations linearise(const Evidence& evidence, std::span<const double> pose) const override;

 private:
  struct Prepared;
  std::vector<std::shared_ptr<const PoseLikelihood>> parts_;
};

}  // namespace silpose
