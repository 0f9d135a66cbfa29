#include "silpose/offline/judged_clip.h"

#include <algorithm>

#include "silpose/base/check.h"
#include "silpose/track/keypoint_sides.h"

namespace silpose {

JudgedClip::JudgedClip(std::span<const ClipInstant> clip, size_t num_cameras) : exchanged_(clip.size(), 0.0) {
  instants_.reserve(clip.size());
  std::vector<int64_t> times;
  times.reserve(clip.size());
  for (const ClipInstant& instant : clip) {
    check(instant.observations.size() == num_cameras, "clip: {} observations for {} cameras",
          instant.observations.size(), num_cameras);
    instants_.push_back(&instant);
    times.push_back(instant.time_ns);
  }
  for (size_t c = 0; c < num_cameras; ++c) {
    std::vector<const Keypoints3D*> keypoints;
    keypoints.reserve(clip.size());
    for (const ClipInstant& instant : clip) keypoints.push_back(&instant.observations[c].keypoints_3d);
    const std::vector<double> exchanged = exchanged_sides(keypoints, times);
    for (size_t t = 0; t < clip.size(); ++t) {
      exchanged_[t] = std::max(exchanged_[t], exchanged[t]);
      if (exchanged[t] <= kExchanged) continue;
      ClipInstant& changed = changed_.try_emplace(t, clip[t]).first->second;
      instants_[t] = &changed;
      changed.observations[c].keypoints_3d = {};
      changed.observations[c].keypoints_2d.clear();
    }
  }
}

}  // namespace silpose
