// LandmarkProposal: poses that agree with the keypoints that were found in the image. The common poses are fitted to
// them; where there are no landmarks, it is the common poses that are proposed.
// Threads: as Proposal.
#pragma once

#include <memory>

#include "silpose/body/body_model.h"
#include "silpose/geometry/camera.h"
#include "silpose/motion/common_poses.h"
#include "silpose/motion/proposal.h"

namespace silpose {

class LandmarkProposal final : public Proposal {
 public:
  // For observations of this camera.
  LandmarkProposal(std::shared_ptr<const BodyModel> body, const PinholeCamera& camera);

  // The best agreement first, those left out that agree far less.
  [[nodiscard]] StateBatch propose(const Observation& observation, int num_candidates, Rng& rng) const override;

 private:
  std::shared_ptr<const BodyModel> body_;
  PinholeCamera camera_;
  CommonPoses common_;
};

}  // namespace silpose
