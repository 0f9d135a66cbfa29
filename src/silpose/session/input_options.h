// InputOptions: which frames of which videos, and how the subject is cut out of them, as a user says it.
// Threads: values and functions without state; the table is constant.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "silpose/base/option_table.h"
#include "silpose/base/result.h"
#include "silpose/segment/segmentation_options.h"
#include "silpose/session/camera_choice.h"
#include "silpose/session/observation_source.h"
#include "silpose/session/run_context.h"
#include "silpose/video/video.h"

namespace silpose {

struct InputOptions {
  std::vector<std::string> videos;  // as open_video() takes them, one per camera
  SegmentationOptions segmentation;
  std::optional<double> default_fps;     // 30 and a warning where it is needed and not given
  std::optional<double> start_s, end_s;  // SourceOptions'

  // Errors: throws OptionError for options that do not fit together.
  void check() const;
};

// Those of the frames; segmentation_option_table() has the others.
const OptionTable<InputOptions>& input_option_table();

// The videos, opened once. Errors: those of open_video(). Throws OptionError as check().
Result<Video> open_input(const InputOptions& options);

// The observations of these videos. Errors: those of segmenter_options() and ObservationSource::open().
Result<std::unique_ptr<ObservationSource>> observations_of(Video video, const InputOptions& options,
                                                           const RunContext& context);

// The observations of the videos with the cameras that belong to them.
struct OpenClip {
  CameraChoice cameras;
  std::unique_ptr<ObservationSource> source;
};

// Errors: those of open_input(), choose_cameras() and observations_of().
Result<OpenClip> open_clip(const InputOptions& input, const CameraOptions& cameras, const RunContext& context);

// Those of the source, and of options that were assumed.
std::vector<std::string> warnings_of(const ObservationSource& source, const InputOptions& options);

}  // namespace silpose
