// TrustMonitor: from masks to observations: how far each can be trusted, from what can be measured without knowing the
// subject.
// Threads: one thread per monitor.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <tuple>
#include <utility>

#include "silpose/image/observation.h"

namespace silpose {

class TrustMonitor {
 public:
  // `ignored`: pixels that no mask says anything about; null: none.
  explicit TrustMonitor(std::shared_ptr<const Mask> ignored = {}) : ignored_(std::move(ignored)) {}

  // Judges the masks of a video in their order; ignored pixels are removed from them.
  Observation judge(Mask mask, ByteImage confidence = {});

  [[nodiscard]] const std::shared_ptr<const Mask>& ignored() const { return ignored_; }

  static auto members(auto& m) { return std::tie(m.recent_areas_); }

 private:
  std::shared_ptr<const Mask> ignored_;
  std::deque<int64_t> recent_areas_;
};

}  // namespace silpose
