// Limbs of any skeleton, found from its tree, and the DOF by which the whole body turns.
// Threads: functions without state.
#pragma once

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "silpose/body/skeleton.h"

namespace silpose {

// A largest subtree without a branching in it.
struct Limb {
  std::vector<int> joints;  // from the trunk outwards
  std::vector<int> dofs;    // ascending; not empty
};

// In order of their first joint.
std::vector<Limb> limbs_of(const Skeleton& skeleton);

// DOF indices of each limb, then those of the trunk (what belongs to no limb; left out when empty). Together they hold
// every DOF once.
std::vector<std::vector<int>> limb_blocks(const Skeleton& skeleton);

// Limbs whose DOF have the same names except for a leading right_ or left_: pairs of indices into `limbs`.
std::vector<std::pair<size_t, size_t>> alike_limbs(const Skeleton& skeleton, std::span<const Limb> limbs);

// The DOF by which the body turns about the vertical: the outermost rotation of the root, if that is its axis.
std::optional<int> turning_dof(const Skeleton& skeleton);

}  // namespace silpose
