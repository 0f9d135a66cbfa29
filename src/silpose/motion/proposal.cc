#include "silpose/motion/proposal.h"

#include "silpose/base/check.h"

namespace silpose {

void check_proposed(const Proposed& proposed, const Skeleton& skeleton) {
  if (proposed.poses.rows() == 0) return;
  check(proposed.poses.cols() == skeleton.num_dofs(), "Proposal: poses of {} numbers for {} DOF", proposed.poses.cols(),
        skeleton.num_dofs());
  check(proposed.poses.allFinite(), "Proposal: a number that is not finite");
  check(proposed.log_density.empty() || std::ssize(proposed.log_density) == proposed.poses.rows(),
        "Proposal: {} densities for {} poses", proposed.log_density.size(), proposed.poses.rows());
}

}  // namespace silpose
