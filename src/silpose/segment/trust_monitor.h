// TrustMonitor: how far a mask can be trusted, by what can be seen of it without knowing the subject.
// Threads: one thread per monitor.
#pragma once

#include <cstdint>
#include <deque>

#include "silpose/segment/segmenter.h"

namespace silpose {

class TrustMonitor {
 public:
  // Judges the masks of a video in their order.
  Segmentation judge(Mask mask, ByteImage confidence = {});

 private:
  std::deque<int64_t> recent_areas_;
};

}  // namespace silpose
