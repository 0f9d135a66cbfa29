// Which frames, and how the subject is cut out of them: the options of commands that read videos.
// Threads: the main thread only.
#pragma once

#include <CLI/CLI.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "apps/silpose/console.h"
#include "silpose/base/result.h"
#include "silpose/session/observation_source.h"
#include "silpose/video/video.h"

namespace silpose::app {

struct InputOptions {
  std::vector<std::string> videos;
  std::string segmenter = "auto";
  std::vector<std::string> masks, backgrounds, regions, garbage_masks;  // one for all, or one per camera
  std::string key_colour = "auto", depth_range;
  std::vector<std::string> depths;  // one per camera
  int grow_px = 0;
  std::optional<int> min_blob_px;     // absent: the segmenter's own
  std::optional<double> default_fps;  // 30 and a warning where it is needed and not given
  std::optional<double> start_s, end_s;
};

void add_input_options(CLI::App& command, InputOptions& options);

// The videos, opened once. Errors: those of open_video(). Throws UsageError for options that do not fit together.
Result<Video> open_input(const InputOptions& options);

// The observations of these videos. Errors: those of ObservationSource::open(); a garbage mask of another size. Throws
// UsageError for an option whose text or number of values does not fit.
Result<std::unique_ptr<ObservationSource>> observations_of(Video video, const InputOptions& options, Console& console);

// Those of the source, and of options that were assumed.
std::vector<std::string> warnings_of(const ObservationSource& source, const InputOptions& options);

}  // namespace silpose::app
