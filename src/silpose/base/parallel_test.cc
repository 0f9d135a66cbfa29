#include "silpose/base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <numeric>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

namespace silpose {
namespace {

TEST(ParallelFor, EveryIndexOnce) {
  for (const size_t count : {size_t{0}, size_t{1}, size_t{7}, size_t{1000}, size_t{100003}}) {
    for (const size_t grain : {size_t{1}, size_t{16}, size_t{1000000}}) {
      std::vector<std::atomic<int>> visits(count);
      parallel_for(count, grain, [&](size_t begin, size_t end) {
        ASSERT_LT(begin, end);
        ASSERT_LE(end, count);
        for (size_t i = begin; i < end; ++i) ++visits[i];
      });
      for (size_t i = 0; i < count; ++i) ASSERT_EQ(visits[i], 1) << i << " of " << count;
    }
  }
}

TEST(ParallelFor, MayNest) {
  std::vector<int> sums(20, 0);
  parallel_for(20, 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      std::vector<int> part(50, 0);
      parallel_for(50, 5, [&](size_t from, size_t to) {
        for (size_t k = from; k < to; ++k) part[k] = static_cast<int>(i * k);
      });
      sums[i] = std::accumulate(part.begin(), part.end(), 0);
    }
  });
  for (int i = 0; i < 20; ++i) EXPECT_EQ(sums[static_cast<size_t>(i)], i * 49 * 50 / 2);
}

TEST(ParallelFor, PassesExceptionsOn) {
  EXPECT_THROW(parallel_for(100, 1,
                            [](size_t begin, size_t) {
                              if (begin == 42) throw std::runtime_error("42");
                            }),
               std::runtime_error);
  EXPECT_THROW(parallel_for(10, 0, [](size_t, size_t) {}), std::invalid_argument);
}

TEST(ThreadLimit, HoldsWhileItLives) {
  const auto threads_used = [] {
    std::mutex mutex;
    std::set<std::thread::id> ids;
    parallel_for(200, 1, [&](size_t, size_t) {
      std::this_thread::sleep_for(std::chrono::microseconds(100));
      const std::lock_guard lock(mutex);
      ids.insert(std::this_thread::get_id());
    });
    return ids.size();
  };
  {
    const ThreadLimit limit(1);
    EXPECT_EQ(threads_used(), 1u);
  }
  if (std::thread::hardware_concurrency() > 1) {
    size_t most = 1;  // a busy machine may take some time to start the others
    for (int attempt = 0; attempt < 100 && most == 1; ++attempt) most = threads_used();
    EXPECT_GT(most, 1u);
  }
  EXPECT_THROW(ThreadLimit(-1), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
