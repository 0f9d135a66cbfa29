#include "silpose/session/camera_choice.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "silpose/base/check.h"
#include "silpose/base/clock.h"
#include "silpose/base/option_error.h"
#include "silpose/geometry/rigid3.h"
#include "silpose/session/clip_camera.h"

namespace silpose {
namespace {

std::string name_list(const std::vector<PinholeCamera>& cameras) {
  std::string names;
  for (const PinholeCamera& camera : cameras) names += (names.empty() ? "" : ", ") + camera.name;
  return names;
}

// A fisheye lens of 8 mm to a long telephoto one of 600 mm; along 16:9 that is 134 to 3.6 degrees.
constexpr double kShortest_mm35 = 8, kLongest_mm35 = 600;
constexpr double kNarrowest_deg = 3, kWidest_deg = 140;

FocalSource focal_source(const CameraOptions& options, const ImageSize& size) {
  if (options.focal_mm35) return {{focal_px_of_mm35(*options.focal_mm35, size.width, size.height), 0}, "--focal-mm35"};
  if (options.fov_deg) {
    return {{focal_px_of_view(to_radians(*options.fov_deg), size.width, size.height), 0}, "--fov-deg"};
  }
  if (size.focal_mm35) return {focal_length_of_metadata(*size.focal_mm35, size.width, size.height), "metadata"};
  return {usual_focal_length(size.width, size.height), "assumed"};
}

// "focal length 960 ± 192 px (as phones and webcams have it)", of an estimate or of what was known before.
std::string focal_text(const Estimated& focal_px, const FocalSource& source) {
  if (source.prior.deviation == 0) return fmt::format("focal length {:.0f} px ({})", focal_px.mean, source.from);
  return fmt::format("focal length {:.0f} ± {:.0f} px ({})", focal_px.mean, focal_px.deviation,
                     source.from == "metadata" ? "from the file's metadata" : "typical of phones and webcams");
}

std::string warning_of(const CameraEstimate& estimate, const FocalSource& source) {
  const double tilt = to_degrees(estimate.tilt.mean);
  return fmt::format(
      "no camera file: estimated from the subject in {} frames: {}, {:.2f} ± {:.2f} m above the floor, tilted {:.0f} ± "
      "{:.0f} degrees {}, for a subject {:.2f} m tall; lengths and angles are only as good as that",
      estimate.num_frames, focal_text(estimate.focal_px, source), estimate.height_m.mean, estimate.height_m.deviation,
      std::abs(tilt), to_degrees(estimate.tilt.deviation), tilt < 0 ? "up" : "down", estimate.body_height_m);
}

void check_focal(const CameraOptions& options) {
  if (options.focal_mm35 && options.fov_deg) throw_option_error("--focal-mm35: not together with --fov-deg");
  if (options.has_file() && (options.focal_mm35 || options.fov_deg)) {
    throw_option_error("{}: not together with --camera {}", options.focal_mm35 ? "--focal-mm35" : "--fov-deg",
                       options.file);
  }
}

CameraChoice assume_camera(const CameraOptions& options, const std::vector<ImageSize>& sizes) {
  if (!options.names.empty()) throw_option_error("--camera-name: needs --camera FILE.toml");
  if (sizes.size() > 1) throw_option_error("several cameras need --camera FILE.toml");
  CameraChoice choice;
  choice.focal = focal_source(options, sizes[0]);
  choice.cameras.push_back(default_camera(sizes[0].width, sizes[0].height));
  choice.cameras[0].fx = choice.cameras[0].fy = choice.focal->prior.focal_px;
  choice.warnings.push_back(fmt::format(
      "no camera file: assumed a level camera 1.5 m above the floor, {}; lengths and angles are only as good as that "
      "guess",
      focal_text(focal_px(choice.focal->prior), *choice.focal)));
  return choice;
}

// The cameras that the options name, in the order of the names.
Result<std::vector<PinholeCamera>> named_cameras(const CameraOptions& options, std::vector<PinholeCamera> all) {
  if (options.names.empty()) return all;
  std::vector<PinholeCamera> named;
  for (const std::string& name : options.names) {
    const auto found = std::ranges::find(all, name, &PinholeCamera::name);
    if (found == all.end()) return error("{}: no camera {} (there are {})", options.file, name, name_list(all));
    named.push_back(*found);
  }
  return named;
}

}  // namespace

const OptionTable<CameraOptions>& camera_option_table() {
  static const OptionTable<CameraOptions> kTable = {
      "The cameras",
      {{"camera", &CameraOptions::file,
        "Calibration file (TOML); of one recorded clip without it, track estimates the camera from the person, or, "
        "with assumed, uses a level camera 1.5 m above the floor"},
       {"camera-name", &CameraOptions::names, "Which camera of the file, once per video"},
       {"camera-up",
        &CameraOptions::up,
        {{"y", UpAxis::kY}, {"z", UpAxis::kZ}},
        "Up axis of the file's world, if the file does not specify it"},
       {"camera-unit",
        &CameraOptions::metres_per_unit,
        {{"m", 1.0}, {"mm", 1e-3}},
        "Unit of the file's lengths, if the file does not specify it"}}};
  return kTable;
}

const OptionTable<CameraOptions>& focal_option_table() {
  static const OptionTable<CameraOptions> kTable = {
      "The focal length of a camera without a file",
      {{"focal-mm35", &CameraOptions::focal_mm35, between(kShortest_mm35, kLongest_mm35),
        "Focal length without --camera FILE: 35 mm equivalent, by the image's diagonal; not estimated further"},
       {"fov-deg", &CameraOptions::fov_deg, between(kNarrowest_deg, kWidest_deg),
        "The same by the field of view along the image's larger side, degrees"}}};
  return kTable;
}

Estimated focal_px(const FocalPrior& prior) { return {prior.focal_px, prior.focal_px * prior.deviation}; }

std::vector<ImageSize> sizes_of(const Video& video) {
  std::vector<ImageSize> sizes;
  sizes.reserve(static_cast<size_t>(video.num_cameras()));
  for (int c = 0; c < video.num_cameras(); ++c) sizes.push_back({video.width(c), video.height(c), video.focal_mm35(c)});
  return sizes;
}

Result<CameraChoice> choose_cameras(const CameraOptions& options, const std::vector<ImageSize>& sizes) {
  check(!options.file.empty() || !sizes.empty(), "choose_cameras: neither a file nor an image size");
  check_focal(options);
  if (!options.has_file() && !sizes.empty()) return assume_camera(options, sizes);
  Result<Calibration> file = load_calibration(options.file, {options.up, options.metres_per_unit});
  if (!file) return file.failure();
  Result<std::vector<PinholeCamera>> named = named_cameras(options, std::move(file->cameras));
  if (!named) return named.failure();
  CameraChoice choice;
  choice.cameras = std::move(*named);
  choice.warnings = std::move(file->warnings);
  if (sizes.empty()) return choice;
  if (choice.cameras.size() != sizes.size()) {
    return error("{}: {} cameras ({}) for {} videos; choose with --camera-name", options.file, choice.cameras.size(),
                 name_list(choice.cameras), sizes.size());
  }
  for (size_t c = 0; c < sizes.size(); ++c) {
    const PinholeCamera& camera = choice.cameras[c];
    if (camera.width != sizes[c].width || camera.height != sizes[c].height) {
      return error("{}: camera {} is calibrated for {}x{}, the video is {}x{}", options.file, camera.name, camera.width,
                   camera.height, sizes[c].width, sizes[c].height);
    }
  }
  return choice;
}

Result<void> estimate_camera_of(ObservationSource& source, double body_height_m, CameraChoice& choice,
                                const RunContext& context) {
  check(choice.focal.has_value(), "estimate_camera_of: the cameras are those of a file");
  const Stopwatch stopwatch;
  Result<ClipCamera> camera = estimate_clip_camera(source, body_height_m, choice.focal->prior, context.progress);
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

}  // namespace silpose
