// ScratchPool: keeps the threads' working memory from one piece of work to the next, so that nothing is allocated once
// every thread has had its own. Threads: any thread may take and return scratch.
#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace silpose {

template <class Scratch>
class ScratchPool {
 public:
  template <class... Args>
  [[nodiscard]] std::unique_ptr<Scratch> take(const Args&... args) {
    {
      const std::lock_guard lock(mutex_);
      if (!free_.empty()) {
        std::unique_ptr<Scratch> scratch = std::move(free_.back());
        free_.pop_back();
        return scratch;
      }
    }
    return std::make_unique<Scratch>(args...);
  }
  void give_back(std::unique_ptr<Scratch> scratch) {
    const std::lock_guard lock(mutex_);
    free_.push_back(std::move(scratch));
  }

 private:
  std::mutex mutex_;
  std::vector<std::unique_ptr<Scratch>> free_;
};

}  // namespace silpose
