#include "silpose/base/serial_queue.h"

#include <utility>

#include "silpose/base/check.h"
#include "silpose/base/clock.h"

namespace silpose {

SerialQueue::SerialQueue(size_t most_waiting) : most_waiting_(most_waiting) {
  check(most_waiting > 0, "SerialQueue: room for no job");
  worker_ = std::thread([this] { work(); });
}

SerialQueue::~SerialQueue() {
  {
    const std::scoped_lock lock(mutex_);
    is_over_ = true;
  }
  changed_.notify_all();
  worker_.join();
}

void SerialQueue::work() {
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [&] { return is_over_ || !waiting_.empty(); });
    if (waiting_.empty()) return;
    const Job job = std::move(waiting_.front());
    waiting_.pop_front();
    if (has_failed_) continue;
    is_busy_ = true;
    lock.unlock();
    changed_.notify_all();
    const Stopwatch stopwatch;
    std::optional<Error> failure;
    std::exception_ptr thrown;
    try {
      if (const Result<void> done = job(); !done) failure = done.error();
    } catch (...) {
      thrown = std::current_exception();
    }
    const double seconds = stopwatch.seconds();
    lock.lock();
    seconds_ += seconds;
    is_busy_ = false;
    has_failed_ = failure || thrown;
    failure_ = std::move(failure);
    thrown_ = std::move(thrown);
    changed_.notify_all();
  }
}

Result<void> SerialQueue::take_error() {
  if (thrown_) std::rethrow_exception(std::exchange(thrown_, nullptr));
  if (failure_) return *std::exchange(failure_, std::nullopt);
  return {};
}

Result<void> SerialQueue::submit(Job job) {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return waiting_.size() < most_waiting_ || has_failed_; });
  if (Result<void> earlier = take_error(); !earlier) return earlier;
  waiting_.push_back(std::move(job));
  lock.unlock();
  changed_.notify_all();
  return {};
}

Result<void> SerialQueue::finish() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return (waiting_.empty() && !is_busy_) || has_failed_; });
  return take_error();
}

double SerialQueue::take_seconds() {
  const std::scoped_lock lock(mutex_);
  return std::exchange(seconds_, 0);
}

}  // namespace silpose
