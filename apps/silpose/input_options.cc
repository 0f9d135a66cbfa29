#include "apps/silpose/input_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "apps/silpose/body_choice.h"
#include "apps/silpose/command.h"
#include "apps/silpose/data_folder.h"
#include "silpose/image/image_file.h"

namespace silpose::app {
namespace {

// One value for all cameras, or one per camera; `fallback` where none is given.
std::string of_camera(const std::string& option, const std::vector<std::string>& values, size_t camera,
                      size_t num_cameras, const std::string& fallback) {
  if (values.empty()) return fallback;
  if (values.size() == 1) return values[0];
  if (values.size() != num_cameras) {
    throw UsageError(fmt::format("{}: given {} times for {} videos", option, values.size(), num_cameras));
  }
  return values[camera];
}

Box parse_region(const std::string& text) {
  const std::vector<double> numbers = parse_numbers("--region", text, 4);
  const bool fits =
      std::all_of(numbers.begin(), numbers.end(), [](double n) { return std::abs(n) < 1e6 && n == std::floor(n); });
  const auto whole = [&](size_t i) { return static_cast<int>(numbers[i]); };
  if (!fits || whole(2) < 1 || whole(3) < 1)
    throw UsageError(fmt::format("--region: {} is not x,y,w,h in whole pixels", text));
  return {whole(0), whole(1), whole(2), whole(3)};
}

CLI::Validator is_key_colour() {
  return CLI::Validator(
      [](const std::string& text) {
        const auto key = parse_key_colour(text);
        return key ? std::string() : key.error().message;
      },
      "");
}

// Options that only one segmenter has.
void check_together(const InputOptions& options) {
  const auto belongs = [&](const char* option, bool given, const char* segmenter) {
    if (given && options.segmenter != segmenter)
      throw UsageError(fmt::format("{}: needs --segmenter {}", option, segmenter));
  };
  belongs("--key-colour", options.key_colour != "auto", "chroma");
  if (!options.depths.empty() && options.segmenter != "depth" && options.segmenter != "background") {
    throw UsageError("--depth: needs --segmenter depth or background");
  }
  belongs("--depth-range", !options.depth_range.empty(), "depth");
  if (options.segmenter == "depth" && options.depths.empty()) throw UsageError("--segmenter depth: needs --depth");
}

std::optional<DepthRange> parse_depth_range(const std::string& text) {
  if (text.empty()) return {};
  const std::vector<double> numbers = parse_numbers("--depth-range", text, 2);
  if (!(numbers[0] >= 0 && numbers[0] < numbers[1] && numbers[1] <= 65.535)) {
    throw UsageError(fmt::format("--depth-range: {} is not MIN,MAX in metres, 0 to 65.535", text));
  }
  return DepthRange{numbers[0], numbers[1]};
}

Result<CleanUpOptions> clean_up_options(const InputOptions& options, const Video& video, size_t camera) {
  const auto count = static_cast<size_t>(video.num_cameras());
  CleanUpOptions clean_up;
  clean_up.grow_px = options.grow_px;
  if (options.min_blob_px) clean_up.min_blob_px = *options.min_blob_px;
  const std::string region = of_camera("--region", options.regions, camera, count, "");
  if (!region.empty()) clean_up.region = parse_region(region);
  const std::string garbage = of_camera("--garbage-mask", options.garbage_masks, camera, count, "");
  if (!garbage.empty()) {
    const Result<Mask> mask = read_mask(garbage);
    if (!mask) return mask.failure();
    const int width = video.width(static_cast<int>(camera)), height = video.height(static_cast<int>(camera));
    if (mask->width() != width || mask->height() != height) {
      return error("{}: {}x{}, but the video is {}x{}", garbage, mask->width(), mask->height(), width, height);
    }
    clean_up.garbage_mask = *mask;
  }
  return clean_up;
}

Result<SegmenterOptions> segmenter_options(const InputOptions& options, const Video& video, size_t camera) {
  const auto count = static_cast<size_t>(video.num_cameras());
  SegmenterOptions segmenter;
  segmenter.kind = options.segmenter;
  const std::string background = of_camera("--background", options.backgrounds, camera, count, "");
  if (!background.empty()) {
    Result<BackgroundOrigin> origin = background_origin_of(background);
    if (!origin) return origin.failure();
    segmenter.background = std::move(*origin);
  }
  segmenter.networks = (data_directory() / "networks").string();
  segmenter.masks = of_camera("--masks", options.masks, camera, count, "");
  segmenter.key_colour = parse_key_colour(options.key_colour).value();
  segmenter.depth = of_camera("--depth", options.depths, camera, count, "");
  segmenter.depth_range = parse_depth_range(options.depth_range);
  Result<CleanUpOptions> clean_up = clean_up_options(options, video, camera);
  if (!clean_up) return clean_up.failure();
  segmenter.clean_up = std::move(*clean_up);
  return segmenter;
}

}  // namespace

void add_input_options(CLI::App& command, InputOptions& options) {
  command.add_option("VIDEO", options.videos, "A file, a folder of pictures, a pattern (img-%06d.png) or camera:N");
  command
      .add_option(
          "--segmenter", options.segmenter,
          "How the person is cut out: masks (given), background, learned (by a network), chroma, depth, or auto: "
          "the first of masks and background that is requested, otherwise learned if scripts/fetch-network-data "
          "has run")
      ->capture_default_str()
      ->check(CLI::IsMember({"auto", "background", "chroma", "depth", "learned", "masks"}));
  command
      .add_option("--background", options.backgrounds,
                  "auto (from the whole clip), online, lead-in:SECONDS, or a video or picture of the empty scene")
      ->allow_extra_args(false);
  command
      .add_option("--key-colour", options.key_colour,
                  "With chroma: the screen's, as #00b140; auto: the commonest saturated colour of the clip")
      ->capture_default_str()
      ->check(is_key_colour());
  command
      .add_option(
          "--depth", options.depths,
          "With depth, and with background to add to its colours: a folder or pattern of 16-bit pictures in mm, "
          "one per frame, once per camera")
      ->allow_extra_args(false);
  command.add_option("--depth-range", options.depth_range,
                     "MIN,MAX in metres: what lies between is the person; without, what is in front of the scene");
  command.add_option("--masks", options.masks, "Masks made elsewhere: a folder, a pattern or a video, once per camera")
      ->allow_extra_args(false);
  command
      .add_option("--region", options.regions,
                  "x,y,w,h in pixels: a blob counts only if at least half of it lies inside; it is not cut")
      ->allow_extra_args(false);
  command
      .add_option("--garbage-mask", options.garbage_masks,
                  "A picture: what is not white in it is removed from the mask and does not count")
      ->allow_extra_args(false);
  command.add_option("--grow", options.grow_px, "Grows the mask by this many pixels; negative shrinks")
      ->capture_default_str()
      ->check(CLI::Range(-64, 64));
  command
      .add_option("--min-blob", options.min_blob_px, "Pixels below which a blob does not count (0.05 % of the picture)")
      ->check(CLI::Range(0, 100'000'000));
  command
      .add_option("--fps", options.default_fps, "Frames per second of input without a frame rate (30, with a warning)")
      ->check(within(0.1, 10000));
  command.add_option("--start", options.start_s, "Seconds (time_s of the results) to begin at")->check(within(0, 1e6));
  command.add_option("--end", options.end_s, "Seconds to end at, included")->check(within(0, 1e6));
}

Result<Video> open_input(const InputOptions& options) {
  if (options.videos.empty()) throw UsageError("VIDEO is missing");
  if (options.start_s && options.end_s && *options.end_s < *options.start_s) {
    throw UsageError(fmt::format("--start {}: is after --end {}", *options.start_s, *options.end_s));
  }
  check_together(options);
  return open_video(options.videos, {.default_fps = options.default_fps.value_or(30)});
}

Result<std::unique_ptr<ObservationSource>> observations_of(Video video, const InputOptions& options, Console& console) {
  SourceOptions source{.segmenters = {}, .start_s = options.start_s, .end_s = options.end_s};
  for (int camera = 0; camera < video.num_cameras(); ++camera) {
    Result<SegmenterOptions> segmenter = segmenter_options(options, video, static_cast<size_t>(camera));
    if (!segmenter) return segmenter.failure();
    source.segmenters.push_back(std::move(*segmenter));
  }
  return ObservationSource::open(std::move(video), std::move(source), &console);
}

std::vector<std::string> warnings_of(const ObservationSource& source, const InputOptions& options) {
  std::vector<std::string> warnings = source.warnings();
  const Video& video = source.video();
  if (video.fps_assumed() && !options.default_fps) {
    warnings.insert(warnings.begin(),
                    fmt::format("{}: has no frame rate, {} frames per second assumed", video.name(), video.fps()));
  }
  return warnings;
}

}  // namespace silpose::app
