// Fitting the tracker's body to the subject of a clip, for `track --fit-body` and `model fit`.
// Threads: the main thread only.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "apps/silpose/console.h"
#include "silpose/track/body_fit.h"
#include "silpose/track/track_clip.h"
#include "silpose/track/tracker_options.h"

namespace silpose::app {

// Tracks the clip online with the body as given: poses [T][D], fewer when interrupted.
std::vector<std::vector<double>> poses_as_given(const TrackerOptions& tracker, std::span<const ClipInstant> clip,
                                                Console& console, const ClipResume& resume = {});

// From these poses fits the body (body_fit.h). Nothing where the clip does not determine the body (why_not_fitted), or
// when interrupted.
std::optional<BodyFit> fit_subject(const TrackerOptions& tracker, std::span<const ClipInstant> clip,
                                   std::span<const std::vector<double>> poses, Console& console);

std::string why_not_fitted(const TrackerOptions& tracker);

// {"lengths_m": {"right_shin_length": {mean, std}, ...}, "girths": {...}, "size": {...}}: what was fitted of these.
nlohmann::ordered_json facts_of(const BodyFit& fit);

// One line for people: "12 bones, girths of 12 groups of bones fitted: 1.770 m, 71.2 kg".
std::string summary_of(const BodyFit& fit);

}  // namespace silpose::app
