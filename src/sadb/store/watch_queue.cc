#include "sadb/store/watch_queue.h"

#include <algorithm>

namespace sadb {

void WatchQueue::offer(const std::vector<Placement>& put) {
  std::vector<Placement> own;
  for (const Placement& placement : put) {
    if (is_at_or_below(placement.series->path, prefix_)) own.push_back(placement);
  }
  if (own.empty()) return;
  const auto num_new = static_cast<int64_t>(own.size());
  std::vector<std::vector<Placement>> dropped;  // freed after the lock
  {
    const std::lock_guard lock(mutex_);
    while (!puts_.empty() && num_queued_ + num_new > capacity_) {
      const auto num_old = static_cast<int64_t>(puts_.front().size());
      num_queued_ -= num_old;
      num_dropped_ += num_old;
      dropped.push_back(std::move(puts_.front()));
      puts_.pop_front();
    }
    num_queued_ += num_new;
    puts_.push_back(std::move(own));
  }
  is_filled_.notify_one();
}

Update WatchQueue::next(std::chrono::nanoseconds timeout) {
  // The clock's own arithmetic overflows with the longest timeouts.
  constexpr std::chrono::nanoseconds kLongest = std::chrono::hours(24 * 365);
  std::deque<std::vector<Placement>> puts;
  Update update;
  {
    std::unique_lock lock(mutex_);
    is_filled_.wait_for(lock, std::min(timeout, kLongest), [&] { return !puts_.empty(); });
    puts.swap(puts_);
    num_queued_ = 0;
    update.num_dropped = std::exchange(num_dropped_, 0);
  }
  for (const std::vector<Placement>& put : puts) {
    for (const Placement& placement : put) {
      update.entries.push_back({placement.series->path, placement.entry->time_ns, placement.entry->value});
    }
  }
  return update;
}

}  // namespace sadb
