// parallel_for(): loops over all cores, by oneTBB. Bodies write only what belongs to their own indices, and sums are
// taken afterwards in index order: results never depend on the number of threads.
// Threads: any thread may call; calls may nest.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace silpose {

// Calls body(begin, end) on disjoint ranges of at most about `grain` indices that together cover [0, count).
void parallel_for(size_t count, size_t grain, const std::function<void(size_t begin, size_t end)>& body);

// While alive, no more than num_threads threads work (0: all cores). An application makes one, first thing.
class ThreadLimit {
 public:
  explicit ThreadLimit(int num_threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace silpose
