// FrameSource: where one camera's images come from: a video file, image files, a live camera, memory. A program's own
// source is one more implementation.
// Threads: one thread per source.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/image/image.h"

namespace silpose {

struct TimedImage {
  ByteImage image;                 // [H, W, 3] B, G, R
  std::optional<int64_t> time_ns;  // since the first image; nullopt where the input has no time for it
};

class FrameSource {
 public:
  virtual ~FrameSource() = default;

  // For messages: a path, "camera:0", "memory".
  [[nodiscard]] virtual const std::string& name() const = 0;

  // The next image, nullopt at the end. Errors: unreadable.
  virtual Result<std::optional<TimedImage>> next() = 0;

  // Back to the first image. May forget what follows until that is read. Errors: a live camera; the input vanished.
  virtual Result<void> rewind() = 0;

  // The rest is optional. It is known once the first image has been read.
  [[nodiscard]] virtual double fps() const { return 0; }               // 0: unknown
  [[nodiscard]] virtual bool has_times() const { return false; }       // images have time_ns
  [[nodiscard]] virtual int64_t num_frames_hint() const { return 0; }  // 0: unknown
  [[nodiscard]] virtual bool is_live() const { return false; }         // cannot rewind; times are the clock's
  // The lens's focal length as the 35 mm equivalent according to the metadata, mm.
  [[nodiscard]] virtual std::optional<double> focal_mm35() const { return {}; }
  // Numbers of the images, one for each, strictly increasing; empty: they are numbered from 0.
  [[nodiscard]] virtual std::span<const int64_t> numbers() const { return {}; }
  // At the end: it came before the input said it would.
  [[nodiscard]] virtual bool broke_off() const { return false; }
  // What the user should know about the images read so far, one line each.
  [[nodiscard]] virtual std::vector<std::string> warnings() const { return {}; }
};

}  // namespace silpose
