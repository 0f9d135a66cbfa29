// The contract of blackboard.h, over every implementation.
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <limits>
#include <memory>
#include <thread>

#include "sadb/board/blackboard.h"
#include "sadb/store/memory_store.h"

namespace sadb {
namespace {

constexpr int64_t kFirst = std::numeric_limits<int64_t>::min(), kLast = std::numeric_limits<int64_t>::max();

struct Implementation {
  const char* name;
  std::function<std::unique_ptr<Blackboard>()> make;
};

class BlackboardContract : public testing::TestWithParam<Implementation> {
 protected:
  std::unique_ptr<Blackboard> board_ = GetParam().make();

  double scalar(int64_t time_ns, Method method) const {
    return std::get<double>(board_->get("x", time_ns, method).value().value);
  }
  void fill() {
    for (const int64_t t : {300, 100, 200}) ASSERT_TRUE(board_->put("x", t, static_cast<double>(t)).ok());
  }
};

TEST_P(BlackboardContract, GivesBackEveryType) {
  silpose::ByteImage image(3, 2, 3, 7);
  const silpose::Mask mask = silpose::mask_from_text("#..\n.##");
  const silpose::Rigid3 transform{Eigen::Matrix3d::Identity(), {1, 2, 3}};
  ASSERT_TRUE(board_->put("scalar", 1, 2.5).ok());
  ASSERT_TRUE(board_->put("vector", 1, std::vector{1.0, 2.0}).ok());
  ASSERT_TRUE(board_->put("text", 1, std::string("hello")).ok());
  ASSERT_TRUE(board_->put("json", 1, Json{"{\"a\":1}"}).ok());
  ASSERT_TRUE(board_->put("transform", 1, transform).ok());
  ASSERT_TRUE(board_->put("pose", 1, Pose{"human", {0.5}}).ok());
  ASSERT_TRUE(board_->put("image", 1, image).ok());
  ASSERT_TRUE(board_->put("mask", 1, mask).ok());
  const auto latest = [&](const char* path) { return board_->get(path, 0, Method::kLatest).value().value; };
  EXPECT_EQ(std::get<double>(latest("scalar")), 2.5);
  EXPECT_EQ(std::get<std::vector<double>>(latest("vector")), (std::vector{1.0, 2.0}));
  EXPECT_EQ(std::get<std::string>(latest("text")), "hello");
  EXPECT_EQ(std::get<Json>(latest("json")).text, "{\"a\":1}");
  EXPECT_EQ(std::get<silpose::Rigid3>(latest("transform")).translation, transform.translation);
  EXPECT_EQ(std::get<Pose>(latest("pose")), (Pose{"human", {0.5}}));
  EXPECT_EQ(std::get<silpose::ByteImage>(latest("image")), image);
  EXPECT_EQ(std::get<silpose::Mask>(latest("mask")), mask);
  for (const PathInfo& info : board_->list("")) EXPECT_EQ(info.path, type_name(info.type));
}

TEST_P(BlackboardContract, AnswersByMethod) {
  fill();
  EXPECT_EQ(scalar(0, Method::kLatest), 300);
  EXPECT_EQ(scalar(149, Method::kNearest), 100);
  EXPECT_EQ(scalar(150, Method::kNearest), 100);
  EXPECT_EQ(scalar(151, Method::kNearest), 200);
  EXPECT_EQ(scalar(-5, Method::kNearest), 100);
  EXPECT_EQ(scalar(999, Method::kNearest), 300);
  EXPECT_EQ(scalar(199, Method::kBefore), 100);
  EXPECT_EQ(scalar(200, Method::kBefore), 200);
  EXPECT_EQ(scalar(200, Method::kAfter), 200);
  EXPECT_EQ(scalar(201, Method::kAfter), 300);
  EXPECT_EQ(scalar(299, Method::kHold), 200);
  EXPECT_EQ(scalar(5000, Method::kHold), 300);
  EXPECT_EQ(scalar(225, Method::kLinear), 225);
}

TEST_P(BlackboardContract, SaysHowAReadingCameAbout) {
  fill();
  const Reading before = board_->get("x", 250, Method::kBefore).value();
  EXPECT_EQ(before.how, How::kRecorded);
  EXPECT_EQ(before.time_ns, 200);
  const Reading held = board_->get("x", 250, Method::kHold).value();
  EXPECT_EQ(held.how, How::kHeld);
  EXPECT_EQ(held.time_ns, 250);
  EXPECT_EQ(held.from_ns, 200);
  EXPECT_EQ(board_->get("x", 200, Method::kHold).value().how, How::kRecorded);
  const Reading linear = board_->get("x", 250, Method::kLinear).value();
  EXPECT_EQ(linear.how, How::kInterpolated);
  EXPECT_EQ(linear.from_ns, 200);
  EXPECT_EQ(linear.to_ns, 300);
}

TEST_P(BlackboardContract, NamesThePathOfWhatItCannotAnswer) {
  fill();
  const auto failure = [&](const char* path, int64_t time_ns, Method method) {
    const auto reading = board_->get(path, time_ns, method);
    return reading.ok() ? std::string("it can") : reading.error().message;
  };
  EXPECT_EQ(failure("y", 0, Method::kLatest), "y: no such path");
  EXPECT_EQ(failure("x", 99, Method::kBefore), "x: no entry at or before 99 ns");
  EXPECT_EQ(failure("x", 99, Method::kHold), "x: no entry at or before 99 ns");
  EXPECT_EQ(failure("x", 301, Method::kAfter), "x: no entry at or after 301 ns");
  EXPECT_EQ(failure("x", 301, Method::kLinear), "x: no entry at or after 301 ns");
  EXPECT_FALSE(board_->range("y", 0, 1).ok());
  EXPECT_EQ(board_->count("y"), 0);
}

TEST_P(BlackboardContract, KeepsTheTypeOfAPath) {
  fill();
  const auto refused = board_->put("x", 400, std::string("four hundred"));
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().message, "x: is of type scalar, not text");
  EXPECT_EQ(board_->count("x"), 3);
}

TEST_P(BlackboardContract, RefusesMalformedPaths) {
  for (const char* bad : {"", "/x", "x/", "a//b"}) EXPECT_FALSE(board_->put(bad, 0, 1.0).ok()) << bad;
  EXPECT_TRUE(board_->list("").empty());
}

TEST_P(BlackboardContract, OneInstantHasOneEntry) {
  fill();
  ASSERT_TRUE(board_->put("x", 200, -1.0).ok());
  EXPECT_EQ(board_->count("x"), 3);
  EXPECT_EQ(scalar(200, Method::kBefore), -1);
}

TEST_P(BlackboardContract, RangesIncludeBothEnds) {
  for (int t = 999; t >= 0; --t) ASSERT_TRUE(board_->put("x", t, static_cast<double>(t)).ok());
  ASSERT_TRUE(board_->put("x", kFirst, 0.0).ok());
  ASSERT_TRUE(board_->put("x", kLast, 0.0).ok());
  const std::vector<Entry> some = board_->range("x", 100, 700).value();
  ASSERT_EQ(some.size(), 601u);
  for (size_t i = 0; i < some.size(); ++i) EXPECT_EQ(some[i].time_ns, 100 + static_cast<int64_t>(i));
  EXPECT_EQ(board_->range("x", kFirst, kLast).value().size(), 1002u);
  EXPECT_EQ(board_->range("x", kLast, kLast).value().size(), 1u);
  EXPECT_TRUE(board_->range("x", 5, 4).value().empty());
}

TEST_P(BlackboardContract, ListsByWholeSegmentsInOrder) {
  for (const char* path : {"b", "a/y", "a.z", "a", "a/x", "ab"}) {
    ASSERT_TRUE(board_->put(path, 3, 1.0).ok());
    ASSERT_TRUE(board_->put(path, 9, 1.0).ok());
  }
  const std::vector<PathInfo> found = board_->list("a");
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].path, "a");
  EXPECT_EQ(found[1].path, "a/x");
  EXPECT_EQ(found[2].path, "a/y");
  EXPECT_EQ(found[2].count, 2);
  EXPECT_EQ(found[2].first_ns, 3);
  EXPECT_EQ(found[2].last_ns, 9);
  EXPECT_EQ(board_->list("").size(), 6u);
  EXPECT_TRUE(board_->list("nowhere").empty());
}

// Four writers on one path and one each of their own, and readers that must always see whole, ordered series.
TEST_P(BlackboardContract, ServesManyThreads) {
  constexpr int kWriters = 4, kEntries = 500;
  std::atomic<bool> writing = true;
  std::atomic<int> disorder = 0;
  constexpr int kReaders = 2;
  std::vector<std::thread> readers;
  readers.reserve(kReaders);
  for (int r = 0; r < kReaders; ++r) {
    readers.emplace_back([&] {
      while (writing) {
        const auto entries = board_->range("shared", kFirst, kLast);
        if (!entries.ok()) continue;
        for (size_t i = 1; i < entries->size(); ++i) {
          if ((*entries)[i - 1].time_ns >= (*entries)[i].time_ns) ++disorder;
        }
        for (const Entry& entry : *entries) {
          if (std::get<std::vector<double>>(entry.value) != std::vector(20, static_cast<double>(entry.time_ns)))
            ++disorder;
        }
        (void)board_->list("");
      }
    });
  }
  std::vector<std::thread> writers;
  writers.reserve(kWriters);
  for (int w = 0; w < kWriters; ++w) {
    writers.emplace_back([&, w] {
      for (int i = 0; i < kEntries; ++i) {
        const int64_t time = static_cast<int64_t>(i) * kWriters + w;
        if (!board_->put("shared", time, std::vector(20, static_cast<double>(time))).ok()) ++disorder;
        if (!board_->put("own/" + std::to_string(w), time, 1.0).ok()) ++disorder;
        if (!board_->get("shared", time, Method::kBefore).ok()) ++disorder;  // a writer sees what it wrote
      }
    });
  }
  for (std::thread& writer : writers) writer.join();
  writing = false;
  for (std::thread& reader : readers) reader.join();
  EXPECT_EQ(disorder, 0);
  EXPECT_EQ(board_->count("shared"), kWriters * kEntries);
  EXPECT_EQ(board_->list("own").size(), static_cast<size_t>(kWriters));
}

INSTANTIATE_TEST_SUITE_P(All, BlackboardContract,
                         testing::Values(Implementation{"Memory", [] { return std::make_unique<MemoryStore>(); }}),
                         [](const auto& param) { return std::string(param.param.name); });

}  // namespace
}  // namespace sadb
