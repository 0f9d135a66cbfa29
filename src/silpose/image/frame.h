// Frame: the images of one instant, one per camera.
// Threads: a value.
#pragma once

#include <cstdint>
#include <vector>

#include "silpose/image/image.h"

namespace silpose {

struct Frame {
  int64_t index = 0;              // counted from the first image of the video; of numbered images their number
  int64_t time_ns = 0;            // of that image in the video's own time
  std::vector<ByteImage> images;  // [C] 8-bit B, G, R
};

}  // namespace silpose
