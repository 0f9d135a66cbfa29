#include "silpose/base/parallel.h"

#include <oneapi/tbb/blocked_range.h>
#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>

#include <algorithm>
#include <thread>

#include "silpose/base/check.h"

namespace silpose {

void parallel_for(size_t count, size_t grain, const std::function<void(size_t, size_t)>& body) {
  check(grain > 0, "parallel_for: grain is 0");
  oneapi::tbb::parallel_for(oneapi::tbb::blocked_range<size_t>(0, count, grain),
                            [&](const auto& range) { body(range.begin(), range.end()); });
}

struct ThreadLimit::Impl {
  explicit Impl(size_t num_threads) : control(oneapi::tbb::global_control::max_allowed_parallelism, num_threads) {}
  oneapi::tbb::global_control control;
};

ThreadLimit::ThreadLimit(int num_threads) {
  check(num_threads >= 0, "ThreadLimit: {} threads", num_threads);
  const size_t all = std::max(1u, std::thread::hardware_concurrency());
  impl_ = std::make_unique<Impl>(num_threads == 0 ? all : static_cast<size_t>(num_threads));
}

ThreadLimit::~ThreadLimit() = default;

}  // namespace silpose
