// SinkQueue: calls a session's sinks on a thread of its own, in order, while the session continues.
// Threads: one thread gives; sinks must not be used elsewhere until finish().
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/base/serial_queue.h"
#include "silpose/image/frame.h"
#include "silpose/image/observation.h"
#include "silpose/session/sink.h"

namespace silpose {

class SinkQueue {
 public:
  explicit SinkQueue(std::vector<std::shared_ptr<SessionSink>> sinks) : sinks_(std::move(sinks)) {}

  // Errors of all: what a sink failed with earlier.
  Result<void> add_observed(std::shared_ptr<const Frame> frame,
                            std::shared_ptr<const std::vector<Observation>> observations);
  Result<void> add_report(StepReport report);
  Result<void> add_tracked(std::shared_ptr<const Frame> frame, const StepReport& report);
  // Until all calls so far are done. Errors: as the others.
  Result<void> finish() { return calls_.finish(); }

  // How long calls took since the last call of this. REQUIRES: finish() was called.
  double take_seconds() { return calls_.take_seconds(); }

  [[nodiscard]] bool needs_tracked_frames() const;
  // REQUIRES: finish() was called.
  [[nodiscard]] const std::vector<std::shared_ptr<SessionSink>>& sinks() const { return sinks_; }

 private:
  template <class Call>
  Result<void> give(Call call);

  std::vector<std::shared_ptr<SessionSink>> sinks_;
  SerialQueue calls_;  // last: its jobs use the rest
};

}  // namespace silpose
