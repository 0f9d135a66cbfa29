// FrameSource: where one camera's pictures come from: a video file, a list of picture files, a live camera. What Video
// is made of; not for use elsewhere.
// Based on: OpenCV's videoio over FFmpeg.
// Threads: one thread per source.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "silpose/base/result.h"
#include "silpose/image/image.h"

namespace silpose {

class FrameSource {
 public:
  virtual ~FrameSource() = default;

  [[nodiscard]] virtual double fps() const { return 0; }               // 0: carries no rate
  [[nodiscard]] virtual int64_t num_frames_hint() const { return 0; }  // 0: unknown
  [[nodiscard]] virtual bool is_live() const { return false; }
  // Of its pictures, growing; empty: they are counted from 0.
  [[nodiscard]] virtual std::span<const int64_t> numbers() const { return {}; }

  // [H, W, 3] The next picture, nothing at the end.
  virtual Result<std::optional<ByteImage>> next() = 0;

  // Back to the first picture.
  virtual Result<void> rewind() = 0;
};

// Errors: missing, empty, not a video, no picture in it, a gap in a numbered sequence.
Result<std::unique_ptr<FrameSource>> open_frame_source(const std::string& input);

// Keeps FFmpeg and OpenCV from printing; for all threads, from the first call on.
void silence_codecs();

}  // namespace silpose
