// Subscription: the entries put onto some paths from now on, as a queue that its owner polls or waits on. To read the
// past as well, subscribe first and then read a range: entries put meanwhile are in both.
// Threads: one thread at a time per subscription; different subscriptions are independent. Writers never wait for one.
#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "sadb/board/entry.h"
#include "silpose/base/result.h"

namespace sadb {

struct Update {
  std::vector<PathEntry> entries;  // of whole puts, in the order in which the board took them
  // Entries that were lost between the last update and the first entry of this one, because the queue was full.
  int64_t num_dropped = 0;

  [[nodiscard]] bool empty() const { return entries.empty() && num_dropped == 0; }
};

// Destroying it ends the subscription.
class Subscription {
 public:
  virtual ~Subscription() = default;

  // All that is queued. Waits until there is something, at most for `timeout`, which may be zero; then the update is
  // empty. Errors: the connection to the board is lost.
  virtual silpose::Result<Update> next(std::chrono::nanoseconds timeout) = 0;
};

struct WatchOptions {
  // Entries that the queue holds. When a put does not fit, the oldest puts in the queue are dropped until it does, each
  // as a whole, and their entries counted. A put that is larger than the queue is then alone in it. REQUIRES: >= 1.
  int64_t capacity = 4096;  // guess: several seconds of a tracker's entries, less than a second at 10 kHz
};

}  // namespace sadb
