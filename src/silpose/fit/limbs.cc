#include "silpose/fit/limbs.h"

#include <utility>

namespace silpose {

std::vector<std::vector<int>> limb_blocks(const BodyModel& body) {
  const int num_dofs = body.skeleton.num_dofs();
  std::vector<std::vector<int>> blocks;
  std::vector<bool> in_limb(static_cast<size_t>(num_dofs), false);
  for (const Limb& limb : body.profile.limbs) {
    for (const int d : limb.dofs) in_limb[static_cast<size_t>(d)] = true;
    blocks.push_back(limb.dofs);
  }
  std::vector<int> trunk;
  for (int d = 0; d < num_dofs; ++d) {
    if (!in_limb[static_cast<size_t>(d)]) trunk.push_back(d);
  }
  if (!trunk.empty()) blocks.push_back(std::move(trunk));
  return blocks;
}

}  // namespace silpose
