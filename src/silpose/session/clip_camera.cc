#include "silpose/session/clip_camera.h"

#include <algorithm>
#include <vector>

namespace silpose {
namespace {

// [guess] Frames that are examined: this many per second, as medians over steps need, but no fewer and no more than
// that.
constexpr double kPerSecond = 4;
constexpr int64_t kFewestSamples = 60, kMostSamples = 240;

int64_t num_samples(const ObservationSource& source) {
  const double seconds = static_cast<double>(source.num_expected()) / source.video().fps();
  return std::clamp(static_cast<int64_t>(kPerSecond * seconds), kFewestSamples, kMostSamples);
}

}  // namespace

Result<ClipCamera> estimate_clip_camera(ObservationSource& source, double body_height_m, const FocalPrior& focal,
                                        ProgressSink* progress) {
  const int64_t expected = source.num_expected(), samples = num_samples(source);
  source.thin_out_to(samples);
  ClipCamera camera;
  std::vector<PersonExtent> whole;
  const auto proceed = [&] {
    return !progress || progress->update("estimating the camera", camera.num_frames, std::min(expected, samples));
  };
  for (;; ++camera.num_frames) {
    camera.stopped = !proceed();
    if (camera.stopped) return camera;
    const Result<std::optional<Instant>> instant = source.next();
    if (!instant) return instant.failure();
    if (!instant->has_value()) break;
    const Observation& seen = (*instant)->observations[0];
    if (seen.trust.nothing_found) continue;
    if (std::optional<PersonExtent> extent = person_extent(seen.mask)) {
      extent->time_s = static_cast<double>((*instant)->frame.time_ns) * 1e-9;
      whole.push_back(*extent);
    }
  }
  camera.stopped = !proceed();
  if (camera.stopped) return camera;
  camera.num_whole = std::ssize(whole);
  if (const Result<void> rewound = source.rewind(); !rewound) return rewound.failure();
  camera.estimate = estimate_camera(whole, source.video().width(), source.video().height(), body_height_m, focal);
  return camera;
}

}  // namespace silpose
