// Blocks of a pose that are drawn, or exchanged, as a whole.
// Threads: a function without state.
#pragma once

#include <vector>

#include "silpose/body/body_model.h"

namespace silpose {

// DOF indices of each limb of the body's profile, then those of the trunk (what belongs to no limb; left out when
// empty). Together they hold every DOF once.
std::vector<std::vector<int>> limb_blocks(const BodyModel& body);

}  // namespace silpose
