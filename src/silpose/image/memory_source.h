// MemorySource: images that the program already has, as a FrameSource.
// Threads: one thread per source.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "silpose/image/frame_source.h"

namespace silpose {

class MemorySource : public FrameSource {
 public:
  // `images`: [T] of [H, W, 3] B, G, R. `fps`: 0 where it is unknown. `times_ns`: [T], strictly increasing, or empty
  // for even times. Errors: throws std::invalid_argument for other channels, a rate outside [0, 1e6], another number of
  // times, times that do not grow.
  explicit MemorySource(std::vector<ByteImage> images, double fps = 0, std::vector<int64_t> times_ns = {},
                        std::string name = "memory");

  [[nodiscard]] const std::string& name() const override { return name_; }
  Result<std::optional<TimedImage>> next() override;
  Result<void> rewind() override;
  [[nodiscard]] double fps() const override { return fps_; }
  [[nodiscard]] bool has_times() const override { return !times_ns_.empty(); }
  [[nodiscard]] int64_t num_frames_hint() const override { return std::ssize(images_); }

 private:
  std::vector<ByteImage> images_;
  double fps_;
  std::vector<int64_t> times_ns_;
  std::string name_;
  size_t next_ = 0;
};

}  // namespace silpose
