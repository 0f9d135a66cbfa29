// Limbs of any skeleton, found from its tree: a limb is a largest subtree without a branching in it; what is left is the
// trunk. For the human: head, legs, arms; and pelvis with spine.
// Threads: functions without state.
#pragma once

#include <span>
#include <vector>

#include "silpose/body/skeleton.h"

namespace silpose {

// DOF indices of each limb, then those of the trunk, ascending within each; joints without DOF add nothing and empty
// limbs are left out. Together they hold every DOF once.
std::vector<std::vector<int>> limb_blocks(const Skeleton& skeleton);

// The pose [D] with the angles of each pair of alike limbs exchanged, one pair at a time and then all at once. Limbs are
// alike when their DOF have the same names but for a leading right_ or left_. From the side a silhouette hardly tells
// which leg is which.
std::vector<std::vector<double>> exchanged_limbs(const Skeleton& skeleton, std::span<const double> pose);

}  // namespace silpose
