#include "silpose/base/serial_queue.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>
#include <vector>

namespace silpose {
namespace {

TEST(SerialQueue, DoesJobsInOrderBesideTheGiver) {
  std::vector<int> done;
  const auto giver = std::this_thread::get_id();
  std::thread::id doer = giver;
  SerialQueue line(2);
  for (int i = 0; i < 20; ++i) {
    ASSERT_TRUE(line.submit([&, i]() -> Result<void> {
      done.push_back(i);
      doer = std::this_thread::get_id();
      return {};
    }));
  }
  ASSERT_TRUE(line.finish());
  ASSERT_EQ(done.size(), 20U);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(done[static_cast<size_t>(i)], i);
  EXPECT_NE(doer, giver);
}

TEST(SerialQueue, GivingWaitsWhereTooManyWait) {
  SerialQueue line(1);
  std::atomic<int> num_done = 0;
  for (int i = 0; i < 4; ++i) {
    ASSERT_TRUE(line.submit([&]() -> Result<void> {
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
      ++num_done;
      return {};
    }));
    EXPECT_LE(i + 1 - num_done, 2);  // one is done, one waits
  }
  ASSERT_TRUE(line.finish());
  EXPECT_EQ(num_done, 4);
  EXPECT_GE(line.take_seconds(), 0.008);
  EXPECT_EQ(line.take_seconds(), 0);
}

TEST(SerialQueue, ReportsAFailureOnceAndDoesNothingAfterIt) {
  SerialQueue line;
  int num_done = 0;
  ASSERT_TRUE(line.submit([]() -> Result<void> { return error("disk: full"); }));
  const Result<void> finished = line.finish();
  ASSERT_FALSE(finished);
  EXPECT_EQ(finished.error().message, "disk: full");
  EXPECT_TRUE(line.submit([&]() -> Result<void> {
    ++num_done;
    return {};
  }));
  EXPECT_TRUE(line.finish());
  EXPECT_EQ(num_done, 0);
}

TEST(SerialQueue, AFailureEndsTheWaitingOfWhoGivesMore) {
  SerialQueue line(1);
  Result<void> given;
  for (int i = 0; i < 100 && given.ok(); ++i) {
    given = line.submit([]() -> Result<void> { return error("no"); });
  }
  EXPECT_FALSE(given);
}

TEST(SerialQueue, ThrowsWhatAJobThrew) {
  SerialQueue line;
  ASSERT_TRUE(line.submit([]() -> Result<void> { throw std::runtime_error("unforeseen"); }));
  EXPECT_THROW((void)line.finish(), std::runtime_error);
}

TEST(SerialQueue, DoesWhatWasGivenBeforeItEnds) {
  int num_done = 0;
  {
    SerialQueue line;
    for (int i = 0; i < 3; ++i) {
      ASSERT_TRUE(line.submit([&]() -> Result<void> {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        ++num_done;
        return {};
      }));
    }
  }
  EXPECT_EQ(num_done, 3);
}

}  // namespace
}  // namespace silpose
