// Limbs of any skeleton, found from its tree: a limb is a largest subtree without a branching in it; what is left is the
// trunk. For the human: head, legs, arms; and pelvis with spine.
// Threads: a function without state.
#pragma once

#include <vector>

#include "silpose/body/skeleton.h"

namespace silpose {

// DOF indices of each limb, then those of the trunk, ascending within each; joints without DOF add nothing and empty
// limbs are left out. Together they hold every DOF once.
std::vector<std::vector<int>> limb_blocks(const Skeleton& skeleton);

}  // namespace silpose
