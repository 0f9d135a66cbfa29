// CommonPoses: a proposal that ignores the observation: the poses in which the rig is most often seen (its profile's),
// facing each of eight directions. For starting a track.
// Source: cormier2019 sect. 2.4.1 (starting from known common poses).
// Threads: as Proposal.
#pragma once

#include <string>
#include <vector>

#include "silpose/body/rig_profile.h"
#include "silpose/motion/proposal.h"

namespace silpose {

class CommonPoses final : public Proposal {
 public:
  // Poses that are equal within the limits are given once; a rig without heading has one direction.
  // Errors: throws std::invalid_argument for a profile without poses, or of another skeleton.
  CommonPoses(const Skeleton& skeleton, const RigProfile& profile);

  // The root's translation is 0. If fewer are requested than exist: a random choice without repetition.
  [[nodiscard]] Proposed propose(const ProposalContext& context, int num_candidates, Rng& rng) const override;

  // All poses [K, D], heading by heading within each named pose; and each row's name.
  [[nodiscard]] const StateBatch& poses() const { return poses_; }
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }

 private:
  StateBatch poses_;
  std::vector<std::string> names_;  // [K] "standing", "t-pose", ...
};

}  // namespace silpose
