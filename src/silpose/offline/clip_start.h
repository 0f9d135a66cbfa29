// The instant of a clip at which tracking begins: where the pose is seen most clearly.
// Threads: a function without state; uses all cores and gives the same result on any number.
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "silpose/offline/judged_clip.h"
#include "silpose/track/tracker_options.h"

namespace silpose {

// Of a few instants whose silhouettes look clear, apart in time, the one where a pose explains the observations best.
// With an initial pose: the first instant that is seen. `seen` [T]. `proceed`: false ends the
// search early.
// REQUIRES: an instant that is seen.
size_t choose_start(const TrackerOptions& options, const JudgedClip& clip, const std::vector<bool>& seen,
                    const std::function<bool()>& proceed);

}  // namespace silpose
