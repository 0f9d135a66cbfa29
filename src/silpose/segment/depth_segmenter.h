// The segmenter by depth images, one a picture: what stands before the scene, or in a range of depths. Made by
// make_segmenter().
// Threads: one thread per segmenter.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "silpose/base/progress.h"
#include "silpose/image/picture_list.h"
#include "silpose/segment/depth_model.h"
#include "silpose/segment/segmenter.h"

namespace silpose {

// Depth images as files; number i belongs to picture number i + offset.
struct DepthFiles {
  std::string name;
  PictureList files;
  int64_t offset = 0;

  [[nodiscard]] int64_t first_number() const { return files.numbers.empty() ? 0 : files.numbers.front(); }
};

// Without a range the background is learned from the clip. Errors: a file that cannot be read, is not 16-bit or has
// another size than width x height; stopped by the progress sink.
Result<std::unique_ptr<Segmenter>> make_depth_segmenter(DepthFiles depth, int width, int height,
                                                        const std::optional<DepthRange>& range,
                                                        const CleanUpOptions& clean_up, ProgressSink* progress);

}  // namespace silpose
