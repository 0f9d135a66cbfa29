#include "silpose/body/random_pose.h"

#include "silpose/base/check.h"

namespace silpose {

std::vector<double> random_pose(const Skeleton& skeleton, std::span<const double> base, Rng& rng,
                                const RandomPoseRange& range) {
  const auto dofs = skeleton.dofs();
  check(base.size() == dofs.size(), "random_pose: a base of {} numbers for {} DOF", base.size(), dofs.size());
  std::vector<double> pose(base.begin(), base.end());
  for (size_t d = 0; d < dofs.size(); ++d) {
    if (dofs[d].is_shape) continue;
    if (dofs[d].is_translation) {
      if (range.shift_m > 0) pose[d] += rng.uniform(-range.shift_m, range.shift_m);
    } else {
      pose[d] += range.part * (rng.uniform(dofs[d].lower, dofs[d].upper) - pose[d]);
    }
  }
  return pose;
}

}  // namespace silpose
