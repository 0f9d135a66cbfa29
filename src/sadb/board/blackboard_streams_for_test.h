// The contract of blackboard.h as tests, second part: cursors, subscriptions, threads.
#pragma once

#include <atomic>
#include <chrono>
#include <thread>

#include "sadb/board/blackboard_contract_for_test.h"

namespace sadb {

class BlackboardStreams : public BlackboardContract {
 protected:
  void fill_to(int64_t count) {
    for (int64_t t = count - 1; t >= 0; --t) ASSERT_TRUE(board_->put("x", t, static_cast<double>(t)));
  }
  std::vector<int64_t> times(const Query& query) const {
    std::vector<int64_t> times;
    for (const Entry& entry : read_range(*board_, "x", query).value()) times.push_back(entry.time_ns);
    return times;
  }
  std::unique_ptr<Subscription> watch(const std::string& prefix, WatchOptions options = {}) {
    return board_->watch(prefix, options).value();
  }
  static std::vector<int64_t> times_of(const std::vector<Entry>& entries) {
    std::vector<int64_t> times;
    for (const Entry& entry : entries) times.push_back(entry.time_ns);
    return times;
  }
};

// "path@time" of each entry.
inline std::vector<std::string> names_of(const Update& update) {
  std::vector<std::string> names;
  for (const PathEntry& entry : update.entries) names.push_back(entry.path + "@" + std::to_string(entry.time_ns));
  return names;
}

// What has arrived.
inline Update poll(Subscription& subscription) { return subscription.next(std::chrono::nanoseconds(0)).value(); }

TEST_P(BlackboardStreams, RangesIncludeBothEnds) {
  fill_to(1000);
  ASSERT_TRUE(board_->put("x", kEarliest, 0.0));
  ASSERT_TRUE(board_->put("x", kEndOfTime, 0.0));
  const std::vector<int64_t> some = times({.from_ns = 100, .to_ns = 700});
  ASSERT_EQ(some.size(), 601u);
  for (size_t i = 0; i < some.size(); ++i) EXPECT_EQ(some[i], 100 + static_cast<int64_t>(i));
  EXPECT_EQ(times({}).size(), 1002u);
  EXPECT_EQ(times({.from_ns = kEndOfTime}).size(), 1u);
  EXPECT_EQ(times({.to_ns = kEarliest}).size(), 1u);
  EXPECT_TRUE(times({.from_ns = 5, .to_ns = 4}).empty());
}

TEST_P(BlackboardStreams, RangesTakeLimitAndStride) {
  fill_to(1000);
  EXPECT_EQ(times({.from_ns = 10, .limit = 3}), (std::vector<int64_t>{10, 11, 12}));
  EXPECT_TRUE(times({.limit = 0}).empty());
  EXPECT_EQ(times({.from_ns = 1, .to_ns = 12, .stride = 5}), (std::vector<int64_t>{1, 6, 11}));
  EXPECT_EQ(times({.from_ns = 1, .limit = 2, .stride = 5}), (std::vector<int64_t>{1, 6}));
  EXPECT_EQ(times({.stride = kEndOfTime}), (std::vector<int64_t>{0}));
  const std::vector<int64_t> thirds = times({.stride = 3});  // over more than one page
  ASSERT_EQ(thirds.size(), 334u);
  for (size_t i = 0; i < thirds.size(); ++i) EXPECT_EQ(thirds[i], static_cast<int64_t>(3 * i));
  EXPECT_THROW((void)board_->range("x", {.limit = -1}), std::invalid_argument);
  EXPECT_THROW((void)board_->range("x", {.stride = 0}), std::invalid_argument);
}

TEST_P(BlackboardStreams, ACursorGivesPages) {
  fill_to(10);
  const auto cursor = board_->range("x", {.from_ns = 1, .stride = 2}).value();
  EXPECT_EQ(times_of(cursor->next(2).value()), (std::vector<int64_t>{1, 3}));
  EXPECT_EQ(times_of(cursor->next(2).value()), (std::vector<int64_t>{5, 7}));
  EXPECT_EQ(times_of(cursor->next(2).value()), (std::vector<int64_t>{9}));
  EXPECT_TRUE(cursor->next(2).value().empty());
  ASSERT_TRUE(board_->put("x", 11, 0.0));
  EXPECT_TRUE(cursor->next(2).value().empty());  // the end stays the end
  EXPECT_THROW((void)cursor->next(0), std::invalid_argument);
}

TEST_P(BlackboardStreams, ACursorSeesWhatIsPutAhead) {
  fill_to(5);
  const auto cursor = board_->range("x", {}).value();
  EXPECT_EQ(times_of(cursor->next(3).value()), (std::vector<int64_t>{0, 1, 2}));
  ASSERT_TRUE(board_->put("x", -1, 0.0));  // behind
  ASSERT_TRUE(board_->put("x", 7, 0.0));   // ahead
  ASSERT_TRUE(board_->remove_range("x", 3, 3).ok());
  EXPECT_EQ(times_of(cursor->next(3).value()), (std::vector<int64_t>{4, 7}));
}

TEST_P(BlackboardStreams, ACursorOfARemovedPathFails) {
  fill_to(5);
  const auto cursor = board_->range("x", {}).value();
  EXPECT_EQ(cursor->next(2).value().size(), 2u);
  ASSERT_TRUE(board_->remove("x"));
  EXPECT_EQ(failure_of(cursor->next(2)), "x: no such path");
}

TEST_P(BlackboardStreams, ASubscriberReceivesWhatIsPutAfterwardsBelowItsPrefix) {
  ASSERT_TRUE(board_->put("a", 1, 1.0));
  const auto subtree = watch("a"), all = watch("");
  EXPECT_TRUE(poll(*subtree).empty());
  ASSERT_TRUE(board_->put("a", 3, 3.0));
  ASSERT_TRUE(board_->put_batch({{"a/x", 2, std::string("two")}, {"ab", 2, 2.0}, {"a/y", 2, 2.0}}));
  ASSERT_TRUE(board_->put("a", 3, 4.0));  // takes the place of an entry
  const Update update = poll(*subtree);
  EXPECT_THAT(names_of(update), testing::ElementsAre("a@3", "a/x@2", "a/y@2", "a@3"));
  EXPECT_EQ(update.num_dropped, 0);
  EXPECT_EQ(std::get<std::string>(update.entries[1].value), "two");
  EXPECT_EQ(std::get<double>(update.entries[0].value), 3);
  EXPECT_EQ(std::get<double>(update.entries[3].value), 4);
  EXPECT_TRUE(poll(*subtree).empty());
  EXPECT_THAT(names_of(poll(*all)), testing::ElementsAre("a@3", "a/x@2", "ab@2", "a/y@2", "a@3"));
}

TEST_P(BlackboardStreams, WhatIsRefusedOrRemovedIsNotReported) {
  fill_to(3);
  const auto subscription = watch("");
  EXPECT_FALSE(board_->put_batch({{"x", 5, 1.0}, {"x", 6, std::string("six")}}).ok());
  ASSERT_TRUE(board_->declare("pose", turning_pose()));
  ASSERT_TRUE(board_->remove_range("x", 0, 1).ok());
  ASSERT_TRUE(board_->remove("x"));
  EXPECT_TRUE(poll(*subscription).empty());
  ASSERT_TRUE(board_->put("x", 7, 1.0));
  ASSERT_TRUE(board_->remove("x"));
  EXPECT_THAT(names_of(poll(*subscription)), testing::ElementsAre("x@7"));
}

TEST_P(BlackboardStreams, AFullQueueDropsTheOldestPutsAndCountsThem) {
  const auto subscription = watch("x", {.capacity = 4});
  ASSERT_TRUE(board_->put_batch({{"x", 1, 0.0}, {"x", 2, 0.0}}));
  ASSERT_TRUE(board_->put_batch({{"x", 3, 0.0}, {"y", 3, 0.0}, {"x", 4, 0.0}}));
  ASSERT_TRUE(board_->put("x", 5, 0.0));
  Update update = poll(*subscription);
  EXPECT_THAT(names_of(update), testing::ElementsAre("x@3", "x@4", "x@5"));
  EXPECT_EQ(update.num_dropped, 2);
  ASSERT_TRUE(board_->put("x", 6, 0.0));
  ASSERT_TRUE(board_->put_batch({{"x", 7, 0.0}, {"x", 8, 0.0}, {"x", 9, 0.0}, {"x", 10, 0.0}, {"x", 11, 0.0}}));
  update = poll(*subscription);
  EXPECT_THAT(names_of(update), testing::ElementsAre("x@7", "x@8", "x@9", "x@10", "x@11"));
  EXPECT_EQ(update.num_dropped, 1);
  EXPECT_THROW((void)board_->watch("x", {.capacity = 0}), std::invalid_argument);
}

TEST_P(BlackboardStreams, AnEndedSubscriptionDisturbsNobody) {
  auto first = watch("x");
  const auto second = watch("x");
  ASSERT_TRUE(board_->put("x", 1, 0.0));
  first.reset();
  ASSERT_TRUE(board_->put("x", 2, 0.0));
  EXPECT_THAT(names_of(poll(*second)), testing::ElementsAre("x@1", "x@2"));
  EXPECT_THAT(names_of(poll(*watch("x"))), testing::IsEmpty());
}

TEST_P(BlackboardStreams, ASubscriberThatWaitsIsWoken) {
  const auto subscription = watch("x");
  EXPECT_TRUE(subscription->next(std::chrono::milliseconds(1)).value().empty());
  std::thread writer([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_TRUE(board_->put("x", 1, 0.0));
  });
  // The longest time there is: without the writer this would not return.
  EXPECT_THAT(names_of(subscription->next(std::chrono::nanoseconds::max()).value()), testing::ElementsAre("x@1"));
  writer.join();
}

// Four writers on one path and one each of their own, and readers that must always see whole, ordered series.
TEST_P(BlackboardStreams, ServesManyThreads) {
  constexpr int kWriters = 4, kEntries = 500, kReaders = 2;
  std::atomic<bool> writing = true;
  std::atomic<int> disorder = 0;
  std::vector<std::thread> readers, writers;
  for (int r = 0; r < kReaders; ++r) {
    readers.emplace_back([&] {
      while (writing) {
        const auto entries = read_range(*board_, "shared");
        if (!entries) continue;
        for (size_t i = 1; i < entries->size(); ++i) {
          if ((*entries)[i - 1].time_ns >= (*entries)[i].time_ns) ++disorder;
        }
        for (const Entry& entry : *entries) {
          const std::vector whole(20, static_cast<double>(entry.time_ns));
          if (std::get<std::vector<double>>(entry.value) != whole) ++disorder;
        }
        if (!board_->list("")) ++disorder;
      }
    });
  }
  for (int w = 0; w < kWriters; ++w) {
    writers.emplace_back([&, w] {
      for (int i = 0; i < kEntries; ++i) {
        const int64_t time = static_cast<int64_t>(i) * kWriters + w;
        if (!board_->put("shared", time, std::vector(20, static_cast<double>(time)))) ++disorder;
        if (!board_->put("own/" + std::to_string(w), time, 1.0)) ++disorder;
        if (!board_->get("shared", time, {Method::kBefore})) ++disorder;  // a writer sees what it wrote
      }
    });
  }
  for (std::thread& writer : writers) writer.join();
  writing = false;
  for (std::thread& reader : readers) reader.join();
  EXPECT_EQ(disorder, 0);
  EXPECT_EQ(board_->count("shared").value(), kWriters * kEntries);
  EXPECT_EQ(board_->list("own").value().size(), static_cast<size_t>(kWriters));
}

// One writer puts the same number onto three paths at a time. Snapshots, lists and updates must never see two numbers,
// while another thread removes the oldest entries; and the watcher must see every number, in order.
TEST_P(BlackboardStreams, NobodySeesAPartOfABatch) {
  constexpr int64_t kBatches = 2000;
  const std::vector<std::string> paths = {"a/x", "b", "c"};
  std::atomic<bool> writing = true;
  std::atomic<int> parts = 0;
  const auto subscription = watch("", {.capacity = 3 * kBatches});
  std::vector<Lookup> lookups;
  for (const std::string& path : paths) lookups.push_back({path, {Method::kLatest}});

  std::thread snapshots([&] {
    while (writing) {
      const auto readings = board_->snapshot(0, lookups).value();
      const auto is_like_first = [&](const auto& reading) {
        if (!reading || !readings[0]) return !reading && !readings[0];
        return reading->time_ns == readings[0]->time_ns;
      };
      if (!std::ranges::all_of(readings, is_like_first)) ++parts;
    }
  });
  std::thread lists([&] {
    while (writing) {
      const std::vector<PathInfo> infos = board_->list("").value();
      if (!infos.empty() && infos.size() != paths.size()) ++parts;
      for (const PathInfo& info : infos) {
        if (info.last_ns != infos[0].last_ns) ++parts;
      }
    }
  });
  std::thread retention([&] {
    while (writing) {
      for (const std::string& path : paths) {
        const auto latest = board_->get(path, 0, {Method::kLatest});
        if (latest && !board_->remove_range(path, kEarliest, latest->time_ns - 10)) ++parts;
      }
    }
  });
  int64_t next_number = 0;
  std::thread watcher([&] {
    while (next_number < kBatches) {
      const Update update = subscription->next(std::chrono::seconds(20)).value();
      if (update.empty() || update.num_dropped > 0 || update.entries.size() % 3 != 0) ++parts;
      if (update.empty()) return;
      for (size_t i = 0; i < update.entries.size(); ++i) {
        if (update.entries[i].path != paths[i % 3]) ++parts;
        if (update.entries[i].time_ns != next_number + static_cast<int64_t>(i / 3)) ++parts;
      }
      next_number += static_cast<int64_t>(update.entries.size() / 3);
    }
  });
  for (int64_t n = 0; n < kBatches; ++n) {
    std::vector<PathEntry> batch;
    for (const std::string& path : paths) batch.push_back({path, n, static_cast<double>(n)});
    EXPECT_TRUE(board_->put_batch(std::move(batch)));
  }
  watcher.join();
  writing = false;
  for (std::thread* thread : {&snapshots, &lists, &retention}) thread->join();
  EXPECT_EQ(parts, 0);
  EXPECT_EQ(next_number, kBatches);
}

}  // namespace sadb
