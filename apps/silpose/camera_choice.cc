#include "apps/silpose/camera_choice.h"

#include <fmt/format.h>

#include <algorithm>

#include "apps/silpose/command.h"
#include "silpose/base/check.h"
#include "silpose/geometry/calibration_file.h"

namespace silpose::app {
namespace {

std::string name_list(const std::vector<PinholeCamera>& cameras) {
  std::string names;
  for (const PinholeCamera& camera : cameras) names += (names.empty() ? "" : ", ") + camera.name;
  return names;
}

}  // namespace

void add_camera_options(CLI::App& command, CameraOptions& options) {
  command.add_option(
      "--camera", options.file,
      "Calibration file (TOML); of one recorded clip without it, track estimates the camera from the person, "
      "or, with assumed, takes it to be level and 1.5 m up");
  command.add_option("--camera-name", options.names, "Which camera of the file, once a video")->allow_extra_args(false);
  command.add_option("--camera-up", options.up, "Up axis of the file's world, where it does not say")
      ->check(CLI::IsMember({"y", "z"}));
  command.add_option("--camera-unit", options.unit, "Unit of the file's lengths, where it does not say")
      ->check(CLI::IsMember({"m", "mm"}));
}

Result<CameraChoice> choose_cameras(const CameraOptions& options, const std::vector<PictureSize>& sizes) {
  CameraChoice choice;
  check(!options.file.empty() || !sizes.empty(), "choose_cameras: neither a file nor a picture size");
  if (!options.has_file() && !sizes.empty()) {
    if (!options.names.empty()) throw UsageError("--camera-name: needs --camera FILE.toml");
    if (sizes.size() > 1) throw UsageError("several cameras need --camera FILE.toml");
    choice.cameras.push_back(default_camera(sizes[0].width, sizes[0].height));
    choice.warnings.push_back(
        fmt::format("no camera file: assumed a level camera 1.5 m above the floor with a focal length of {:.0f} px; "
                    "lengths and angles are only as good as that guess",
                    choice.cameras[0].fx));
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
