// SerialQueue: a thread that does one job after another while the thread that submits them continues, such as writing a
// frame's files while the next frame is computed. Jobs are done in the order they were given.
// Threads: one thread gives jobs; what a job uses must not be used elsewhere until finish().
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <optional>
#include <thread>

#include "silpose/base/result.h"

namespace silpose {

class SerialQueue {
 public:
  using Job = std::function<Result<void>()>;

  // `most_waiting`: jobs submitted and not begun, before submit() blocks: it bounds the memory that they hold.
  explicit SerialQueue(size_t most_waiting = 4);
  SerialQueue(const SerialQueue&) = delete;
  SerialQueue& operator=(const SerialQueue&) = delete;
  ~SerialQueue();  // completes the jobs that were submitted

  // Errors: what an earlier job failed with, reported once; no job is run after it. What a job throws is thrown here.
  Result<void> submit(Job job);

  // Waits until all jobs are done. Errors: as submit().
  Result<void> finish();

  // How long jobs took since the last call of this. REQUIRES: finish() was called.
  double take_seconds();

 private:
  void work();
  Result<void> take_error();

  const size_t most_waiting_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Job> waiting_;
  bool is_busy_ = false, is_over_ = false, has_failed_ = false;
  std::optional<Error> failure_;
  std::exception_ptr thrown_;
  double seconds_ = 0;
  std::thread worker_;  // last: it uses the rest
};

}  // namespace silpose
