// Proposal: candidate poses for an observation, from another source than the last frame: a list, a network, a database.
// The tracker weighs candidates like any particle, so a proposal may be wrong.
//
// Proposals are used at the start, where a track is found again, and for the particles that a filter regenerates.
//
// Contract: the candidates are whole poses within the skeleton's limits, none where nothing is recognised. Where the
// root is need not be right at starts, which place candidates on the mask; regenerated particles are drawn about
// candidates as they are. The same context and Rng give the same candidates.
//
// Threads: proposals are constant; any thread may call.
#pragma once

#include <span>
#include <vector>

#include "silpose/base/rng.h"
#include "silpose/body/skeleton.h"
#include "silpose/filter/state_batch.h"
#include "silpose/geometry/camera.h"
#include "silpose/image/observation.h"

namespace silpose {

// What a proposal may use.
struct ProposalContext {
  std::span<const Observation> observations;  // [C]
  std::span<const PinholeCamera> cameras;     // [C]
  std::span<const double> last_pose = {};     // [D] the last estimate; empty: there is none
  double dt_s = 0;                            // since the last estimate
};

struct Proposed {
  StateBatch poses;  // [K, D]
  // [K] The log probability density with which each was proposed, up to a constant; empty: all are alike. Particles
  // that are drawn from candidates are drawn in proportion.
  std::vector<double> log_density = {};
};

// Errors: throws std::invalid_argument unless there are poses [K, D] of finite numbers, with K densities or none. A
// proposal without poses passes.
void check_proposed(const Proposed& proposed, const Skeleton& skeleton);

class Proposal {
 public:
  virtual ~Proposal() = default;

  // At most num_candidates; 0 requests all that the proposal has, or finds worth trying. REQUIRES: num_candidates >= 0.
  [[nodiscard]] virtual Proposed propose(const ProposalContext& context, int num_candidates, Rng& rng) const = 0;
};

}  // namespace silpose
