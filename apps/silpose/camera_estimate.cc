#include "apps/silpose/camera_estimate.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "silpose/base/clock.h"
#include "silpose/geometry/rigid3.h"

namespace silpose::app {
namespace {

// Frames that are examined: this many per second, as medians over steps need, but no fewer and no more than that.
constexpr double kPerSecond = 4;
constexpr int64_t kFewestSamples = 60, kMostSamples = 240;

int64_t num_samples(const ObservationSource& source) {
  const double seconds = static_cast<double>(source.num_expected()) / source.video().fps();
  return std::clamp(static_cast<int64_t>(kPerSecond * seconds), kFewestSamples, kMostSamples);
}

struct Extents {
  std::vector<PersonExtent> whole;  // of frames that show the whole subject
  int64_t num_frames = 0;           // examined
};

Result<Extents> read_extents(ObservationSource& source, Console& console) {
  const int64_t expected = source.num_expected(), samples = num_samples(source);
  source.thin_out_to(samples);
  Extents extents;
  for (;; ++extents.num_frames) {
    if (!console.update("estimating the camera", extents.num_frames, std::min(expected, samples))) break;
    const Result<std::optional<Instant>> instant = source.next();
    if (!instant) return instant.failure();
    if (!instant->has_value()) break;
    const Observation& seen = (*instant)->observations[0];
    if (seen.trust.nothing_found) continue;
    if (std::optional<PersonExtent> extent = person_extent(seen.mask)) {
      extent->time_s = static_cast<double>((*instant)->frame.time_ns) * 1e-9;
      extents.whole.push_back(*extent);
    }
  }
  return extents;
}

nlohmann::ordered_json figure(const Estimated& value, double unit = 1) {
  return {{"mean", unit * value.mean}, {"std", unit * value.deviation}};
}

std::string warning_of(const CameraEstimate& estimate, const FocalSource& source) {
  const double tilt = to_degrees(estimate.tilt.mean);
  return fmt::format(
      "no camera file: estimated from the subject in {} frames: {}, {:.2f} ± {:.2f} m above the floor, tilted {:.0f} ± "
      "{:.0f} degrees {}, for a subject {:.2f} m tall; lengths and angles are only as good as that",
      estimate.num_frames, focal_text(estimate.focal_px, source), estimate.height_m.mean, estimate.height_m.deviation,
      std::abs(tilt), to_degrees(estimate.tilt.deviation), tilt < 0 ? "up" : "down", estimate.body_height_m);
}

}  // namespace

Result<void> estimate_camera_of(ObservationSource& source, double body_height_m, CameraChoice& choice,
                                Console& console) {
  const Stopwatch stopwatch;
  const Result<Extents> extents = read_extents(source, console);
  if (!extents) return extents.failure();
  if (Console::interrupted()) return error("interrupted before the first frame");
  if (const Result<void> rewound = source.rewind(console); !rewound) return rewound;
  const PinholeCamera& assumed = choice.cameras[0];
  choice.estimate = estimate_camera(extents->whole, assumed.width, assumed.height, body_height_m, choice.focal->prior);
  choice.estimating_s = stopwatch.seconds();
  if (!choice.estimate) {
    choice.warnings.push_back(
        fmt::format("the camera was not estimated: too few of {} frames examined show the subject whole and upright "
                    "(whole: {})",
                    extents->num_frames, extents->whole.size()));
    return {};
  }
  choice.cameras = {choice.estimate->camera};
  choice.warnings = {warning_of(*choice.estimate, *choice.focal)};
  return {};
}

nlohmann::ordered_json facts_of(const CameraEstimate& estimate) {
  return {{"focal_px", figure(estimate.focal_px)},
          {"height_m", figure(estimate.height_m)},
          {"tilt_deg", figure(estimate.tilt, to_degrees(1))},
          {"roll_deg", figure(estimate.roll, to_degrees(1))},
          {"frames", estimate.num_frames},
          {"body_height_m", estimate.body_height_m}};
}

}  // namespace silpose::app
