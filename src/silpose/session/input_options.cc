#include "silpose/session/input_options.h"

#include <fmt/format.h>

#include <utility>

#include "silpose/base/option_error.h"

namespace silpose {

const OptionTable<InputOptions>& input_option_table() {
  static const OptionTable<InputOptions> kTable = {
      "The frames",
      {{"fps", &InputOptions::default_fps, between(0.1, 10000),
        "Frames per second of input without a frame rate (30, with a warning)"},
       {"start", &InputOptions::start_s, between(0, 1e6), "Seconds (time_s of the results) to begin at"},
       {"end", &InputOptions::end_s, between(0, 1e6), "Seconds to end at, included"}}};
  return kTable;
}

void InputOptions::check() const {
  if (videos.empty()) throw_option_error("VIDEO is missing");
  if (start_s && end_s && *end_s < *start_s) throw_option_error("--start {}: is after --end {}", *start_s, *end_s);
  segmentation.check();
}

Result<Video> open_input(const InputOptions& options) {
  options.check();
  return open_video(options.videos, {.default_fps = options.default_fps.value_or(30)});
}

Result<std::unique_ptr<ObservationSource>> observations_of(Video video, const InputOptions& options,
                                                           const RunContext& context) {
  auto segmenters = segmenter_options(options.segmentation, video, context.data / "networks");
  if (!segmenters) return segmenters.failure();
  return ObservationSource::open(
      std::move(video), {.segmenters = std::move(*segmenters), .start_s = options.start_s, .end_s = options.end_s},
      context.progress);
}

Result<OpenClip> open_clip(const InputOptions& input, const CameraOptions& cameras, const RunContext& context) {
  Result<Video> video = open_input(input);
  if (!video) return video.failure();
  Result<CameraChoice> choice = choose_cameras(cameras, sizes_of(*video));
  if (!choice) return choice.failure();
  auto source = observations_of(std::move(*video), input, context);
  if (!source) return source.failure();
  return OpenClip{std::move(*choice), std::move(*source)};
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

}  // namespace silpose
