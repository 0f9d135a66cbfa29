// BlobSegmenter: the common part of segmenters that find all foreground first and then decide which of it is the
// subject.
// Threads: one thread per segmenter.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "silpose/base/state_bytes.h"
#include "silpose/segment/clean_up.h"
#include "silpose/segment/segmenter.h"
#include "silpose/segment/trust_monitor.h"

namespace silpose {

class BlobSegmenter : public Segmenter {
 public:
  // `garbage_mask`: CleanUpOptions'.
  explicit BlobSegmenter(const std::optional<Mask>& garbage_mask) : monitor_(removed_by(garbage_mask)) {}

  void expect(Mask silhouette) final { expected_ = std::move(silhouette); }
  [[nodiscard]] std::shared_ptr<const Mask> ignored() const final { return monitor_.ignored(); }
  [[nodiscard]] std::string state() const final { return to_bytes(monitor_); }
  void restore(std::string_view state) final { check(from_bytes(state, monitor_), "BlobSegmenter: not a state of it"); }

 protected:
  // choose_blob() with what is expected of this image, and of no later one.
  Mask subject_of(const Mask& foreground, const CleanUpOptions& clean_up) {
    return choose_blob(foreground, clean_up, std::exchange(expected_, {}));
  }
  Observation judge(Mask mask, ByteImage confidence = {}) {
    return monitor_.judge(std::move(mask), std::move(confidence));
  }

 private:
  TrustMonitor monitor_;
  Mask expected_;
};

}  // namespace silpose
