#include "silpose/track/track_clip.h"

#include <utility>

#include "silpose/track/tracker.h"

namespace silpose {

std::vector<StepReport> track_clip(const TrackerOptions& options, std::span<const ClipInstant> clip,
                                   const ClipProgress& progress) {
  Tracker tracker(options);
  std::vector<StepReport> reports;
  reports.reserve(clip.size());
  for (const ClipInstant& instant : clip) {
    reports.push_back(tracker.step(instant.observations, instant.frame_idx, instant.time_ns));
    if (progress && !progress(reports.size(), clip.size())) break;
  }
  return reports;
}

}  // namespace silpose
