// TrustMonitor: how far a mask can be trusted, from what can be measured without knowing the subject.
// Threads: one thread per monitor.
#pragma once

#include <cstdint>
#include <deque>
#include <tuple>

#include "silpose/segment/segmenter.h"

namespace silpose {

class TrustMonitor {
 public:
  // Judges the masks of a video in their order.
  Segmentation judge(Mask mask, ByteImage confidence = {});

  static auto members(auto& m) { return std::tie(m.recent_areas_); }

 private:
  std::deque<int64_t> recent_areas_;
};

}  // namespace silpose
