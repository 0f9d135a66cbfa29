// ProgressSink: how long-running work reports its progress, and learns that it should stop. Libraries never print.
// Threads: update() is called by one thread at a time.
#pragma once

#include <cstdint>
#include <string_view>

namespace silpose {

class ProgressSink {
 public:
  virtual ~ProgressSink() = default;

  // `done` of `total` units of `what` are done (total 0: unknown). Returns false to ask the work to stop cleanly.
  virtual bool update(std::string_view what, int64_t done, int64_t total) = 0;
};

}  // namespace silpose
