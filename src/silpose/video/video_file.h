// VideoFile: the images of a video file as a player shows them (upright, square pixels, one field of interlaced ones,
// 8-bit B, G, R whatever the depth), each at the time its container says. Made by open_frame_source().
// Based on: FFmpeg's libavformat, libavcodec and libswscale.
// Threads: one thread per source.
#pragma once

#include <memory>
#include <string>

#include "silpose/base/result.h"
#include "silpose/image/frame_source.h"

namespace silpose {

// Errors: not a video; sound alone; an MP4 without its index; no decoder.
Result<std::unique_ptr<FrameSource>> open_video_file(const std::string& path);

}  // namespace silpose
