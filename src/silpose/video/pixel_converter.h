// PixelConverter: a decoded image, of any depth and colour, to 8-bit B, G, R by its own colour matrix and range; HDR
// as a screen of standard range shows it (tone_map.h).
// Based on: FFmpeg's libswscale.
// Threads: one thread per converter.
#pragma once

#include <opencv2/core.hpp>
#include <optional>

#include "silpose/base/result.h"
#include "silpose/video/ffmpeg.h"
#include "silpose/video/tone_map.h"

namespace silpose {

// How an HDR image is coded; nothing: it is of standard range.
std::optional<HdrTransfer> hdr_transfer_of(const AVFrame& frame);

class PixelConverter {
 public:
  // [H, W, 3] Valid until the next call. Errors: too large, no memory, pixels of an unknown kind.
  Result<cv::Mat> convert(const AVFrame& frame);

 private:
  struct Kind {
    int width = 0, height = 0, format = 0;
    AVColorSpace colour_space = AVCOL_SPC_UNSPECIFIED;
    AVColorRange range = AVCOL_RANGE_UNSPECIFIED;
    std::optional<HdrTransfer> hdr = {};
    bool operator==(const Kind&) const = default;
  };
  Result<void> prepare(const Kind& kind);

  Kind kind_;            // of what the others are made for
  ScalerHandle scaler_;  // none: nothing yet
  FrameHandle converted_;
  cv::Mat toned_;  // of HDR
};

}  // namespace silpose
