// FrameSource: where one camera's pictures come from: a video file, a list of picture files, a live camera. Used by
// Video; not for use elsewhere.
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

struct Picture {
  ByteImage image;                 // [H, W, 3]
  std::optional<int64_t> time_ns;  // since the first picture; nothing where the input has no times
};

class FrameSource {
 public:
  virtual ~FrameSource() = default;

  // Known once the first picture has been read.
  [[nodiscard]] virtual double fps() const { return 0; }  // 0: carries no rate
  [[nodiscard]] virtual bool has_times() const { return false; }
  [[nodiscard]] virtual int64_t num_frames_hint() const { return 0; }  // 0: unknown
  [[nodiscard]] virtual bool is_live() const { return false; }
  // The lens's focal length as the 35 mm equivalent from the input's metadata, mm; nothing where they lack it.
  [[nodiscard]] virtual std::optional<double> focal_mm35() const { return {}; }
  // The numbers of its pictures, ascending; empty: they are counted from 0.
  [[nodiscard]] virtual std::span<const int64_t> numbers() const { return {}; }

  // The next picture, nothing at the end.
  virtual Result<std::optional<Picture>> next() = 0;
  // At the end: whether it came earlier than the input announced.
  [[nodiscard]] virtual bool broke_off() const { return false; }
  // What the user should know about the pictures read so far, one line each.
  [[nodiscard]] virtual std::vector<std::string> warnings() const { return {}; }

  // Back to the first picture.
  virtual Result<void> rewind() = 0;
};

}  // namespace silpose
