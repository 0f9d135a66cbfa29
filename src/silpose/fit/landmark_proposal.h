// LandmarkProposal: poses that agree with the keypoints that were found in the image. The common poses are fitted to
// them; where there are no landmarks, it is the common poses that are proposed.
// Threads: as Proposal.
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "silpose/body/body_model.h"
#include "silpose/image/observation.h"
#include "silpose/motion/common_poses.h"
#include "silpose/motion/proposal.h"

namespace silpose {

class LandmarkProposal final : public Proposal {
 public:
  explicit LandmarkProposal(std::shared_ptr<const BodyModel> body);

  // By the camera of start_camera(): the best agreement first, those left out that agree far less.
  [[nodiscard]] Proposed propose(const ProposalContext& context, int num_candidates, Rng& rng) const override;

 private:
  std::shared_ptr<const BodyModel> body_;
  CommonPoses common_;
};

// The camera whose observation starts use: the first one with keypoints, else the first. Shapes: one observation per
// camera.
size_t start_camera(std::span<const Observation> observations);

}  // namespace silpose
