// WatchQueue: the subscription of MemoryStore: a bounded queue of whole puts.
// Threads: offer() from any thread, one at a time (the store's lock); next() from one other.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "sadb/board/subscription.h"
#include "sadb/store/series.h"

namespace sadb {

// An entry on its way into a series.
struct Placement {
  std::shared_ptr<Series> series;
  SharedEntry entry;
};

class WatchQueue {
 public:
  WatchQueue(std::string prefix, int64_t capacity) : prefix_(std::move(prefix)), capacity_(capacity) {}

  // Appends those of a put that are at or below the prefix.
  void offer(const std::vector<Placement>& put);

  // As Subscription::next().
  Update next(std::chrono::nanoseconds timeout);

 private:
  const std::string prefix_;
  const int64_t capacity_;

  std::mutex mutex_;
  std::condition_variable is_filled_;
  std::deque<std::vector<Placement>> puts_;
  int64_t num_queued_ = 0, num_dropped_ = 0;  // entries
};

}  // namespace sadb
