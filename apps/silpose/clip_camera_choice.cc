#include "apps/silpose/clip_camera_choice.h"

#include <fmt/format.h>

#include <cmath>

#include "apps/silpose/run_facts.h"
#include "silpose/base/clock.h"
#include "silpose/geometry/rigid3.h"
#include "silpose/session/clip_camera.h"

namespace silpose::app {
namespace {

nlohmann::ordered_json figure_of(const Estimated& value, double unit = 1) {
  return figure(unit * value.mean, unit * value.deviation);
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
  Result<ClipCamera> camera = estimate_clip_camera(source, body_height_m, choice.focal->prior, &console);
  if (!camera) return camera.failure();
  if (camera->stopped) return error("interrupted before the first frame");
  choice.estimating_s = stopwatch.seconds();
  choice.estimate = std::move(camera->estimate);
  if (!choice.estimate) {
    choice.warnings.push_back(
        fmt::format("the camera was not estimated: too few of {} frames examined show the subject whole and upright "
                    "(whole: {})",
                    camera->num_frames, camera->num_whole));
    return {};
  }
  choice.cameras = {choice.estimate->camera};
  choice.warnings = {warning_of(*choice.estimate, *choice.focal)};
  return {};
}

nlohmann::ordered_json facts_of(const CameraEstimate& estimate) {
  return {{"focal_px", figure_of(estimate.focal_px)},
          {"height_m", figure_of(estimate.height_m)},
          {"tilt_deg", figure_of(estimate.tilt, to_degrees(1))},
          {"roll_deg", figure_of(estimate.roll, to_degrees(1))},
          {"frames", estimate.num_frames},
          {"body_height_m", estimate.body_height_m}};
}

}  // namespace silpose::app
