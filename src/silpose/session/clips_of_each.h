// clips_of_each(): `silpose track --each`: every video is a clip of its own, with its result in a folder of its name.
// Threads: functions without state.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "silpose/session/track_options.h"

namespace silpose {

struct ClipOfEach {
  TrackOptions options;       // of this clip alone
  std::filesystem::path out;  // of its result
};

// One clip per video, in order: "walks/one.mp4" has its result in out/one; a folder keeps its name.
// Errors: throws OptionError for live input, videos without a name or of one name, and options that belong to one clip
// or to several cameras.
std::vector<ClipOfEach> clips_of_each(const TrackOptions& options, const std::filesystem::path& out);

}  // namespace silpose
