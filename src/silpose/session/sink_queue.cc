#include "silpose/session/sink_queue.h"

#include <algorithm>
#include <utility>

namespace silpose {

template <class Call>
Result<void> SinkQueue::give(Call call) {
  return calls_.submit([this, call = std::move(call)]() -> Result<void> {
    for (const auto& sink : sinks_) {
      if (Result<void> done = call(*sink); !done) return done;
    }
    return {};
  });
}

Result<void> SinkQueue::add_observed(std::shared_ptr<const Frame> frame,
                                     std::shared_ptr<const std::vector<Observation>> observations) {
  return give([frame = std::move(frame), seen = std::move(observations)](SessionSink& sink) {
    return sink.add_observed(*frame, *seen);
  });
}

Result<void> SinkQueue::add_report(StepReport report) {
  return give([report = std::make_shared<const StepReport>(std::move(report))](SessionSink& sink) {
    return sink.add_report(*report);
  });
}

Result<void> SinkQueue::add_tracked(std::shared_ptr<const Frame> frame, const StepReport& report) {
  return give([frame = std::move(frame), report](SessionSink& sink) {
    return sink.needs_tracked_frames() ? sink.add_tracked(*frame, report) : Result<void>();
  });
}

bool SinkQueue::needs_tracked_frames() const {
  return std::ranges::any_of(sinks_, [](const auto& sink) { return sink->needs_tracked_frames(); });
}

}  // namespace silpose
