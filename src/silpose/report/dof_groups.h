// Groups of degrees of freedom for a page to show together: the chains of joints between which a skeleton branches
// ("abdomen, thorax", "thigh to foot"), named after the skeleton's own joints, for any skeleton.
// Threads: a pure function.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "silpose/body/skeleton.h"

namespace silpose {

// [D] the group of every DOF. The root is a group of its own. A chain whose joints are all of one side is named without
// the side, so that right and left limbs share a group. A chain of more than 8 joints that move is cut into even parts.
std::vector<std::string> dof_groups(const Skeleton& skeleton);

// "left", "right" or "", by how the name begins.
std::string_view side_of(std::string_view name);

}  // namespace silpose
