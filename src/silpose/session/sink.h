// SessionSink: what receives the masks, poses and frames of a session as they come: files, a blackboard, a window.
// Threads: a session calls its sinks from one thread, in order, while the next frame is segmented and tracked.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "silpose/base/check.h"
#include "silpose/base/result.h"
#include "silpose/body/body_model.h"
#include "silpose/image/frame.h"
#include "silpose/image/observation.h"
#include "silpose/track/step_report.h"

namespace silpose {

// Every call may fail: the session ends with that error. Nothing is called after a failure.
class SessionSink {
 public:
  virtual ~SessionSink() = default;

  // The next frame and its observations [C], before its pose is known.
  virtual Result<void> add_observed(const Frame& /*frame*/, std::span<const Observation> /*observations*/) {
    return {};
  }

  // The next report: of a clip that is tracked as a whole after all of its frames were observed. A resumed session
  // gives those of its earlier part again, without StepReport::observed.
  virtual Result<void> add_report(const StepReport& /*report*/) { return {}; }

  // The next frame with its report. A clip that is tracked as a whole, or resumed, is read once more for it.
  virtual Result<void> add_tracked(const Frame& /*frame*/, const StepReport& /*report*/) { return {}; }
  [[nodiscard]] virtual bool needs_tracked_frames() const { return false; }

  // Reports are of this body from now on: it was fitted to the subject.
  virtual void set_body(std::shared_ptr<const BodyModel> /*body*/) {}

  // After the last call of the others, also where the session was stopped early.
  virtual Result<void> finish() { return {}; }

  // What add_observed() carries from frame to frame, for a session that is resumed.
  // Errors: restore() throws std::invalid_argument for what is no such state.
  [[nodiscard]] virtual std::string state() const { return {}; }
  virtual void restore(std::string_view state) { check(state.empty(), "SessionSink: not a state of it"); }
};

}  // namespace silpose
