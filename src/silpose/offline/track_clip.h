// track_clip(): tracks a whole recorded clip. Without smoothing it is Tracker::step over its instants.
// Threads: a function without state; uses all cores and gives the same result on any number.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "silpose/offline/clip_instant.h"
#include "silpose/track/step_report.h"
#include "silpose/track/tracker_options.h"

namespace silpose {

// Called after each instant; tracking ends early when it returns false.
using ClipProgress = std::function<bool(size_t instants_done, size_t instants_total)>;

// What lets the tracking of a clip resume where an earlier call, with the same arguments, was stopped.
struct ClipResume {
  std::string state;  // which that call last gave to keep(); empty: from the start
  // Called after each instant of each pass, and when tracking ends early. `state()` is the progress so far.
  std::function<void(const std::function<std::string()>& state)> keep;
};

// One report per instant that was tracked, in order. Times must grow.
// Errors: throws std::invalid_argument as TrackerOptions::check(), where observations do not fit the cameras, or for a
// state of another call.
std::vector<StepReport> track_clip(const TrackerOptions& options, std::span<const ClipInstant> clip,
                                   const ClipProgress& progress = {}, const ClipResume& resume = {});

}  // namespace silpose
