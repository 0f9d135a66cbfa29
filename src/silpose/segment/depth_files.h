// Depth images as files, one per image of the clip they belong to.
// Threads: a value; its functions only read.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "silpose/base/progress.h"
#include "silpose/base/result.h"
#include "silpose/image/image_file.h"
#include "silpose/image/image_list.h"

namespace silpose {

inline constexpr size_t kDepthSamples = 40;  // [guess] that a background is learned from

// Number i belongs to image number i + offset.
struct DepthFiles {
  std::string name;
  ImageList files;
  int64_t offset = 0;
  int width = 0, height = 0;  // of the images

  [[nodiscard]] int64_t first_number() const { return files.numbers.empty() ? 0 : files.numbers.front(); }

  // Of image number `index`. Errors: there is none; it cannot be read, is not 16-bit or has another size.
  [[nodiscard]] Result<DepthImage> image_of(int64_t index) const;

  // At most `most` spread over all. Errors: those of image_of(); stopped by the progress sink.
  [[nodiscard]] Result<std::vector<DepthImage>> samples(size_t most, ProgressSink* progress) const;
};

}  // namespace silpose
