#include "apps/silpose/camera_choice.h"

#include <fmt/format.h>

#include <algorithm>

#include "apps/silpose/command.h"
#include "silpose/base/check.h"
#include "silpose/geometry/calibration_file.h"
#include "silpose/geometry/rigid3.h"

namespace silpose::app {
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

Estimated focal_px(const FocalPrior& prior) { return {prior.focal_px, prior.focal_px * prior.deviation}; }

}  // namespace

void add_camera_options(CLI::App& command, CameraOptions& options) {
  command.add_option(
      "--camera", options.file,
      "Calibration file (TOML); of one recorded clip without it, track estimates the camera from the person, "
      "or, with assumed, uses a level camera 1.5 m above the floor");
  command.add_option("--camera-name", options.names, "Which camera of the file, once per video")
      ->allow_extra_args(false);
  command.add_option("--camera-up", options.up, "Up axis of the file's world, if the file does not specify it")
      ->check(CLI::IsMember({"y", "z"}));
  command.add_option("--camera-unit", options.unit, "Unit of the file's lengths, if the file does not specify it")
      ->check(CLI::IsMember({"m", "mm"}));
}

void add_focal_options(CLI::App& command, CameraOptions& options) {
  command
      .add_option(
          "--focal-mm35", options.focal_mm35,
          "Focal length without --camera FILE: 35 mm equivalent, by the picture's diagonal; not estimated further")
      ->check(within(kShortest_mm35, kLongest_mm35));
  command
      .add_option("--fov-deg", options.fov_deg,
                  "The same by the field of view along the picture's larger side, degrees")
      ->check(within(kNarrowest_deg, kWidest_deg));
}

std::string focal_text(const Estimated& focal_px, const FocalSource& source) {
  if (source.prior.deviation == 0) return fmt::format("focal length {:.0f} px ({})", focal_px.mean, source.from);
  return fmt::format("focal length {:.0f} ± {:.0f} px ({})", focal_px.mean, focal_px.deviation,
                     source.from == "metadata" ? "from the file's metadata" : "typical of phones and webcams");
}

nlohmann::ordered_json facts_of(const FocalSource& source) {
  const Estimated focal = focal_px(source.prior);
  return {{"mean", focal.mean}, {"std", focal.deviation}, {"from", source.from}};
}

std::vector<ImageSize> sizes_of(const Video& video) {
  std::vector<ImageSize> sizes;
  sizes.reserve(static_cast<size_t>(video.num_cameras()));
  for (int c = 0; c < video.num_cameras(); ++c) sizes.push_back({video.width(c), video.height(c), video.focal_mm35(c)});
  return sizes;
}

Result<CameraChoice> choose_cameras(const CameraOptions& options, const std::vector<ImageSize>& sizes) {
  CameraChoice choice;
  if (options.focal_mm35 && options.fov_deg) throw UsageError("--focal-mm35: not together with --fov-deg");
  if (options.has_file() && (options.focal_mm35 || options.fov_deg)) {
    throw UsageError(fmt::format("{}: not together with --camera {}", options.focal_mm35 ? "--focal-mm35" : "--fov-deg",
                                 options.file));
  }
  check(!options.file.empty() || !sizes.empty(), "choose_cameras: neither a file nor a picture size");
  if (!options.has_file() && !sizes.empty()) {
    if (!options.names.empty()) throw UsageError("--camera-name: needs --camera FILE.toml");
    if (sizes.size() > 1) throw UsageError("several cameras need --camera FILE.toml");
    choice.focal = focal_source(options, sizes[0]);
    choice.cameras.push_back(default_camera(sizes[0].width, sizes[0].height));
    choice.cameras[0].fx = choice.cameras[0].fy = choice.focal->prior.focal_px;
    choice.warnings.push_back(fmt::format(
        "no camera file: assumed a level camera 1.5 m above the floor, {}; lengths and angles are only as good as that "
        "guess",
        focal_text(focal_px(choice.focal->prior), *choice.focal)));
    return choice;
  }

  CalibrationOptions reading;
  if (!options.up.empty()) reading.up = options.up == "z" ? UpAxis::kZ : UpAxis::kY;
  if (!options.unit.empty()) reading.metres_per_unit = options.unit == "mm" ? 1e-3 : 1.0;
  Result<Calibration> file = load_calibration(options.file, reading);
  if (!file) return file.failure();
  choice.warnings = file->warnings;
  if (options.names.empty()) {
    choice.cameras = file->cameras;
  } else {
    for (const std::string& name : options.names) {
      const auto found = std::find_if(file->cameras.begin(), file->cameras.end(),
                                      [&](const PinholeCamera& camera) { return camera.name == name; });
      if (found == file->cameras.end()) {
        return error("{}: no camera {} (there are {})", options.file, name, name_list(file->cameras));
      }
      choice.cameras.push_back(*found);
    }
  }
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

}  // namespace silpose::app
