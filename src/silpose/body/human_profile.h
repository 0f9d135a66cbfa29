// The rig profile of the human (human_skeleton() in human/human.h): tables for people who walk and gesture.
// Threads: functions without state.
#pragma once

#include "silpose/body/rig_profile.h"

namespace silpose {

// For a skeleton with the human's DOF, and perhaps others, which keep the defaults of tree_profile().
[[nodiscard]] RigProfile human_profile(const Skeleton& skeleton);

// Whether the skeleton's joints are called as those of human_skeleton(), in its order.
[[nodiscard]] bool has_human_joints(const Skeleton& skeleton);

}  // namespace silpose
