// Proposal: candidate poses for an observation, from another source than the last frame: a list, a network, a database.
// The tracker weighs candidates like any particle, so a proposal may be wrong.
//
// Contract: the candidates are whole poses within the skeleton's limits. Where the root is need not be right: the
// tracker places candidates on the mask. The same observation and Rng give the same candidates.
//
// Threads: proposals are constant; any thread may call.
#pragma once

#include "silpose/base/rng.h"
#include "silpose/filter/state_batch.h"
#include "silpose/image/observation.h"

namespace silpose {

class Proposal {
 public:
  virtual ~Proposal() = default;

  // Poses [K, D], K at most num_candidates; 0 requests all that the proposal has, or finds worth trying.
  // REQUIRES: num_candidates >= 0.
  [[nodiscard]] virtual StateBatch propose(const Observation& observation, int num_candidates, Rng& rng) const = 0;
};

}  // namespace silpose
