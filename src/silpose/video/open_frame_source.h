// The FrameSource of an input's name: a video file, image files or a live camera ("camera:N").
// Threads: a function without state.
#pragma once

#include <memory>
#include <string>

#include "silpose/base/result.h"
#include "silpose/image/frame_source.h"

namespace silpose {

// Errors: missing, empty, not a video, no image in it, a gap in a numbered sequence.
Result<std::unique_ptr<FrameSource>> open_frame_source(const std::string& input);

}  // namespace silpose
