// silpose calibrate: cameras from a printed board.
#include <fmt/format.h>

#include <memory>

#include "apps/silpose/command.h"
#include "silpose/base/option_error.h"
#include "silpose/base/whole_file.h"
#include "silpose/calibrate/calibrate.h"
#include "silpose/geometry/calibration_file.h"
#include "silpose/session/board_search.h"
#include "silpose/session/run_facts.h"

namespace silpose::app {
namespace {

namespace fs = std::filesystem;

struct CalibrateOptions {
  std::vector<std::string> videos, names;
  std::string out, board = "9x6";
  std::optional<double> square_mm, floor_s, fps;
};

Outcome outcome_of(const CalibrateOptions& options, const BoardSearch& search, const CameraCalibration& calibration,
                   const std::vector<std::string>& warnings, const CommonOptions& common) {
  Outcome outcome;
  outcome.json = run_facts(common.program);
  outcome.json["frames_searched"] = search.num_searched;
  outcome.json["cameras"] = nlohmann::ordered_json::array();
  for (size_t c = 0; c < calibration.cameras.size(); ++c) {
    const PinholeCamera& camera = calibration.cameras[c];
    const CameraFit& fit = calibration.fits[c];
    outcome.json["cameras"].push_back({{"name", camera.name},
                                       {"video", options.videos[c]},
                                       {"size", {camera.width, camera.height}},
                                       {"frames_with_board", search.cameras[c].sightings.size()},
                                       {"views", fit.num_views},
                                       {"rms_px", fit.rms_px},
                                       {"focal_px", {camera.fx, camera.fy}},
                                       {"focal_sd_px", fit.focal_sd_px},
                                       {"coverage", fit.coverage}});
    outcome.text += fmt::format(
        "{}: {} views of {} frames with the board, RMS {:.3f} px, focal length {:.1f} \u00b1 {:.1f} px\n", camera.name,
        fit.num_views, search.cameras[c].sightings.size(), fit.rms_px, (camera.fx + camera.fy) / 2, fit.focal_sd_px);
  }
  outcome.json["rms_px"] = calibration.rms_px;
  outcome.json["floor"] = search.floor_instant ? "board" : "assumed";
  outcome.json["warnings"] = warnings;
  outcome.json["out"] = options.out;
  outcome.text += fmt::format("written to {}", options.out);
  return outcome;
}

Result<Outcome> run_calibrate(const CalibrateOptions& options, const CommonOptions& common, Console& console) {
  const Board board = board_of(options.board, options.square_mm.value_or(0), options.videos.size());
  if (!options.square_mm) throw_option_error("--square is missing: the side of a square in mm, measured on the print");
  const std::vector<std::string> names = camera_names_of(options.videos, options.names);
  if (fs::is_directory(options.out)) return error("{}: is a directory", options.out);
  const Result<BoardSearch> search = search_board(board, options.videos, names, options.floor_s, options.fps, console);
  if (!search) return search.failure();
  console.update("fitting cameras", 0, 0);
  const Result<CameraCalibration> calibration = calibrate_cameras(board, search->cameras, search->floor_instant);
  if (!calibration) return calibration.failure();
  if (Console::interrupted()) return error("interrupted");
  const Result<void> written =
      write_whole(options.out, [&](const fs::path& path) { return write_cameras(path, calibration->cameras); });
  if (!written) return written.failure();
  std::vector<std::string> warnings = search->warnings;
  warnings.insert(warnings.end(), calibration->warnings.begin(), calibration->warnings.end());
  for (const std::string& warning : warnings) console.warning(warning);
  return outcome_of(options, *search, *calibration, warnings, common);
}

}  // namespace

Command add_calibrate(CLI::App& program, const CommonOptions& common) {
  const auto options = std::make_shared<CalibrateOptions>();
  CLI::App* const app = program.add_subcommand("calibrate", "Cameras from a printed chessboard moved in front of them");
  app->add_option(
         "VIDEO", options->videos,
         "Videos of the board, tilted in all directions, all over the image; one per camera, in step, same board")
      ->required();
  app->add_option("--out", options->out, "Calibration file (TOML) for --camera of the other commands")->required();
  app->add_option("--board", options->board, "Inner corners, COLUMNSxROWS")->capture_default_str();
  app->add_option("--square", options->square_mm, "Side of a square, mm")->check(within(0.1, 10'000));
  app->add_option(
         "--floor-frame", options->floor_s,
         "Seconds: when the board lies on the floor, y = 0; without it the first camera is assumed to be level")
      ->check(within(0, 1e6));
  app->add_option("--fps", options->fps, "Frames per second of input without a frame rate (30, with a warning)")
      ->check(within(0.1, 10'000));
  app->add_option("--camera-name", options->names, "Name of a camera, once per video (default: the files' names)")
      ->allow_extra_args(false);
  return {app, [options, &common](Console& console) { return run_calibrate(*options, common, console); }};
}

}  // namespace silpose::app
