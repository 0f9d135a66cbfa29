// KeypointLikelihood: keypoint_term.h of every camera as a likelihood.
// Threads: as PoseLikelihood.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "silpose/geometry/camera.h"
#include "silpose/likelihood/keypoint_term.h"
#include "silpose/likelihood/pose_likelihood.h"

namespace silpose {

struct KeypointOptions {
  bool alone = false;  // nothing else determines where the body is: places have weight 1
  bool places = true;  // false: only directions count
  double share = 1;    // of the log-likelihood; less where other evidence is weighed by less than its likelihood, too
};

class KeypointLikelihood final : public PoseLikelihood {
 public:
  // REQUIRES: a body; at least one camera.
  KeypointLikelihood(std::shared_ptr<const BodyModel> body, std::vector<PinholeCamera> cameras,
                     KeypointOptions options);

  [[nodiscard]] const BodyModel& body() const override { return *body_; }
  // A camera that found nothing, or too few keypoints to determine a pose, adds nothing.
  [[nodiscard]] std::unique_ptr<const Evidence> prepare(std::span<const Observation> observations) const override;
  void add_log_likelihood(const Evidence& evidence, const StateBatch& states, std::span<double> out) const override;
  [[nodiscard]] bool can_linearise() const override { return true; }
  [[nodiscard]] NormalEquations linearise(const Evidence& evidence, std::span<const double> pose) const override;

 private:
  struct Prepared;
  std::shared_ptr<const BodyModel> body_;
  std::vector<PinholeCamera> cameras_;
  KeypointOptions options_;
};

}  // namespace silpose
