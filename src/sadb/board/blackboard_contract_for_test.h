// The contract of blackboard.h as tests, for every implementation. A store's test includes this file and
// blackboard_streams_for_test.h, in one source file, and instantiates both:
//   INSTANTIATE_TEST_SUITE_P(Memory, BlackboardContract, testing::Values(MakeBoard([] { return ...; })));
// This file: values, access by time, schemas, batches, snapshots, removal.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sadb/board/blackboard.h"

namespace sadb {

using MakeBoard = std::function<std::unique_ptr<Blackboard>()>;

inline constexpr int64_t kEarliest = std::numeric_limits<int64_t>::min();
inline constexpr int64_t kEndOfTime = std::numeric_limits<int64_t>::max();

class BlackboardContract : public testing::TestWithParam<MakeBoard> {
 protected:
  std::unique_ptr<Blackboard> board_ = GetParam()();

  Value value_at(const std::string& path, int64_t time_ns, Method method) const {
    return board_->get(path, time_ns, {method}).value().value;
  }
  double scalar(int64_t time_ns, Method method) const { return std::get<double>(value_at("x", time_ns, method)); }
  // Entries of x at 100, 200 and 300 ns with these values.
  void fill() {
    for (const int64_t t : {300, 100, 200}) ASSERT_TRUE(board_->put("x", t, static_cast<double>(t)));
  }
  std::vector<std::string> paths() const {
    std::vector<std::string> paths;
    for (const PathInfo& info : board_->list("").value()) paths.push_back(info.path);
    return paths;
  }
};

// The message of a failure.
template <class T>
std::string failure_of(const silpose::Result<T>& result) {
  return result.ok() ? std::string("it can") : result.error().message;
}

// A skeleton that turns without end in degrees and in radians, bends, and moves.
inline Schema turning_pose() {
  using Kind = PoseDof::Kind;
  return {Type::kPose, PoseSchema{"turner",
                                  {{"heading", Kind::kRotation, "deg", 360},
                                   {"roll", Kind::kRotation, "rad", 2 * silpose::kPi},
                                   {"bend", Kind::kRotation, "deg", 0},
                                   {"x", Kind::kTranslation, "m", 0}}}};
}

TEST_P(BlackboardContract, GivesBackEveryType) {
  const silpose::ByteImage image(3, 2, 3, 7);
  const silpose::Mask mask = silpose::mask_from_text("#..\n.##");
  const silpose::Rigid3 transform{Eigen::Matrix3d::Identity(), {1, 2, 3}};
  ASSERT_TRUE(board_->put("scalar", 1, 2.5));
  ASSERT_TRUE(board_->put("vector", 1, std::vector{1.0, 2.0}));
  ASSERT_TRUE(board_->put("text", 1, std::string("hello")));
  ASSERT_TRUE(board_->put("json", 1, Json{"{\"a\":1}"}));
  ASSERT_TRUE(board_->put("transform", 1, transform));
  ASSERT_TRUE(board_->put("pose", 1, Pose{"human", {0.5}}));
  ASSERT_TRUE(board_->put("image", 1, image));
  ASSERT_TRUE(board_->put("mask", 1, mask));
  const auto latest = [&](const char* path) { return value_at(path, 0, Method::kLatest); };
  EXPECT_EQ(std::get<double>(latest("scalar")), 2.5);
  EXPECT_EQ(std::get<std::vector<double>>(latest("vector")), (std::vector{1.0, 2.0}));
  EXPECT_EQ(std::get<std::string>(latest("text")), "hello");
  EXPECT_EQ(std::get<Json>(latest("json")).text, "{\"a\":1}");
  EXPECT_EQ(std::get<silpose::Rigid3>(latest("transform")).translation, transform.translation);
  EXPECT_EQ(std::get<Pose>(latest("pose")), (Pose{"human", {0.5}}));
  EXPECT_EQ(*std::get<Shared<silpose::ByteImage>>(latest("image")), image);
  EXPECT_EQ(*std::get<Shared<silpose::Mask>>(latest("mask")), mask);
  const std::vector<PathInfo> infos = board_->list("").value();
  EXPECT_EQ(infos.size(), 8u);
  for (const PathInfo& info : infos) EXPECT_EQ(info.path, type_name(info.type));
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

TEST_P(BlackboardContract, SaysHowAReadingWasObtained) {
  fill();
  const Reading before = board_->get("x", 250, {Method::kBefore}).value();
  EXPECT_EQ(before.how, How::kRecorded);
  EXPECT_EQ(before.time_ns, 200);
  const Reading held = board_->get("x", 250, {Method::kHold}).value();
  EXPECT_EQ(held.how, How::kHeld);
  EXPECT_EQ(held.time_ns, 250);
  EXPECT_EQ(held.from_ns, 200);
  EXPECT_EQ(board_->get("x", 200, {Method::kHold}).value().how, How::kRecorded);
  const Reading linear = board_->get("x", 250, {Method::kLinear}).value();
  EXPECT_EQ(linear.how, How::kInterpolated);
  EXPECT_EQ(linear.time_ns, 250);
  EXPECT_EQ(linear.from_ns, 200);
  EXPECT_EQ(linear.to_ns, 300);
}

TEST_P(BlackboardContract, NamesThePathOfWhatItCannotAnswer) {
  fill();
  const auto failure = [&](const char* path, int64_t time_ns, Method method) {
    return failure_of(board_->get(path, time_ns, {method}));
  };
  EXPECT_EQ(failure("y", 0, Method::kLatest), "y: no such path");
  EXPECT_EQ(failure("x", 99, Method::kBefore), "x: no entry at or before 99 ns");
  EXPECT_EQ(failure("x", 99, Method::kHold), "x: no entry at or before 99 ns");
  EXPECT_EQ(failure("x", 301, Method::kAfter), "x: no entry at or after 301 ns");
  EXPECT_EQ(failure("x", 301, Method::kLinear), "x: no entry at or after 301 ns");
  EXPECT_EQ(failure_of(board_->range("y", {})), "y: no such path");
  EXPECT_EQ(failure_of(board_->schema("y")), "y: no such path");
  EXPECT_EQ(board_->count("y").value(), 0);
}

TEST_P(BlackboardContract, RefusesMalformedPaths) {
  for (const char* bad : {"", "/x", "x/", "a//b", "a\nb"}) {
    EXPECT_FALSE(board_->put(bad, 0, 1.0).ok()) << bad;
    EXPECT_FALSE(board_->declare(bad, {Type::kScalar}).ok()) << bad;
  }
  EXPECT_TRUE(board_->list("").value().empty());
}

TEST_P(BlackboardContract, OneInstantHasOneEntry) {
  fill();
  ASSERT_TRUE(board_->put("x", 200, -1.0));
  EXPECT_EQ(board_->count("x").value(), 3);
  EXPECT_EQ(scalar(200, Method::kBefore), -1);
}

TEST_P(BlackboardContract, ListsByWholeSegmentsInOrder) {
  for (const char* path : {"b", "a/y", "a.z", "a", "a/x", "ab"}) {
    ASSERT_TRUE(board_->put(path, 3, 1.0));
    ASSERT_TRUE(board_->put(path, 9, 1.0));
  }
  const std::vector<PathInfo> found = board_->list("a").value();
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].path, "a");
  EXPECT_EQ(found[1].path, "a/x");
  EXPECT_EQ(found[2].path, "a/y");
  EXPECT_EQ(found[2].count, 2);
  EXPECT_EQ(found[2].first_ns, 3);
  EXPECT_EQ(found[2].last_ns, 9);
  EXPECT_EQ(board_->list("").value().size(), 6u);
  EXPECT_TRUE(board_->list("nowhere").value().empty());
}

TEST_P(BlackboardContract, TheFirstEntryFixesTheTypeAlone) {
  fill();
  EXPECT_EQ(board_->schema("x").value(), Schema{Type::kScalar});
  EXPECT_EQ(failure_of(board_->put("x", 400, std::string("four hundred"))), "x: is of type scalar, not text");
  EXPECT_EQ(board_->count("x").value(), 3);
  ASSERT_TRUE(board_->put("pose", 0, Pose{"human", {170}}));
  ASSERT_TRUE(board_->put("pose", 1, Pose{"snake", {1, 2}}));
  EXPECT_EQ(board_->schema("pose").value(), Schema{Type::kPose});
}

TEST_P(BlackboardContract, ADeclaredPathHasASchemaAndNoEntries) {
  ASSERT_TRUE(board_->declare("pose", turning_pose()));
  EXPECT_EQ(board_->schema("pose").value(), turning_pose());
  const std::vector<PathInfo> infos = board_->list("pose").value();
  ASSERT_EQ(infos.size(), 1u);
  EXPECT_EQ(infos[0].type, Type::kPose);
  EXPECT_EQ(infos[0].count, 0);
  EXPECT_EQ(board_->count("pose").value(), 0);
  EXPECT_TRUE(read_range(*board_, "pose").value().empty());
  EXPECT_EQ(failure_of(board_->get("pose", 0, {Method::kLatest})), "pose: no entries");
  EXPECT_EQ(failure_of(board_->get("pose", 0, {Method::kNearest})), "pose: no entries");
  EXPECT_EQ(failure_of(board_->get("pose", 5, {Method::kLinear})), "pose: no entry at or before 5 ns");
}

TEST_P(BlackboardContract, ASchemaIsFixedOnce) {
  ASSERT_TRUE(board_->declare("pose", turning_pose()));
  EXPECT_TRUE(board_->declare("pose", turning_pose()).ok());
  Schema other = turning_pose();
  other.pose->dofs[0].period = 0;
  EXPECT_EQ(failure_of(board_->declare("pose", other)), "pose: has another schema already");
  EXPECT_EQ(board_->schema("pose").value(), turning_pose());
  ASSERT_TRUE(board_->put("early", 0, Pose{"turner", {0, 0, 0, 0}}));
  EXPECT_TRUE(board_->declare("early", {Type::kPose}).ok());
  EXPECT_EQ(failure_of(board_->declare("early", turning_pose())), "early: has another schema already");
}

TEST_P(BlackboardContract, RefusesSchemasThatMakeNoSense) {
  Schema scalar = turning_pose();
  scalar.type = Type::kScalar;
  EXPECT_EQ(failure_of(board_->declare("p", scalar)), "p: type scalar has no degrees of freedom");
  Schema twice = turning_pose();
  twice.pose->dofs[1].name = "heading";
  EXPECT_EQ(failure_of(board_->declare("p", twice)), "p: two degrees of freedom are called heading");
  Schema backwards = turning_pose();
  backwards.pose->dofs[1].period = -1;
  EXPECT_EQ(failure_of(board_->declare("p", backwards)), "p: roll: a period of -1");
  Schema nameless = turning_pose();
  nameless.pose->dofs[2].name = "";
  EXPECT_EQ(failure_of(board_->declare("p", nameless)), "p: a degree of freedom without a name");
  EXPECT_TRUE(board_->list("").value().empty());
}

TEST_P(BlackboardContract, RefusesWhatContradictsTheSchema) {
  ASSERT_TRUE(board_->declare("pose", turning_pose()));
  EXPECT_EQ(failure_of(board_->put("pose", 0, std::vector{1.0, 2.0, 3.0, 4.0})), "pose: is of type pose, not vector");
  EXPECT_EQ(failure_of(board_->put("pose", 0, Pose{"human", {1, 2, 3, 4}})),
            "pose: is of skeleton 'turner', not 'human'");
  EXPECT_EQ(failure_of(board_->put("pose", 0, Pose{"turner", {1, 2, 3}})), "pose: poses have 4 values, not 3");
  EXPECT_EQ(board_->count("pose").value(), 0);
  EXPECT_TRUE(board_->put("pose", 0, Pose{"turner", {1, 2, 3, 4}}).ok());
}

TEST_P(BlackboardContract, PeriodicValuesGoTheShortWay) {
  const Pose before{"turner", {179, 3, 179, 0}}, after{"turner", {-179, -3, -179, 1}};
  ASSERT_TRUE(board_->declare("pose", turning_pose()));
  for (const char* path : {"pose", "undeclared"}) {
    ASSERT_TRUE(board_->put(path, 0, before));
    ASSERT_TRUE(board_->put(path, 100, after));
  }
  const auto pose = [&](const char* path, int64_t time_ns) {
    return std::get<Pose>(value_at(path, time_ns, Method::kLinear)).values;
  };
  EXPECT_NEAR(pose("pose", 50)[0], 180, 1e-12);
  EXPECT_NEAR(pose("pose", 50)[1], silpose::kPi, 1e-12);
  EXPECT_NEAR(pose("pose", 50)[2], 0, 1e-12);
  EXPECT_NEAR(pose("pose", 50)[3], 0.5, 1e-12);
  EXPECT_NEAR(pose("pose", 25)[0], 179.5, 1e-12);
  EXPECT_NEAR(pose("pose", 75)[0], 180.5, 1e-12);
  EXPECT_EQ(pose("pose", 100)[0], -179);  // an entry is given as it was put
  EXPECT_NEAR(pose("undeclared", 50)[0], 0, 1e-12);
}

TEST_P(BlackboardContract, TakesABatchAsAWhole) {
  ASSERT_TRUE(board_->put_batch({{"a/x", 5, 1.0}, {"a/y", 5, std::string("one")}, {"a/x", 6, 2.0}, {"a/x", 5, 3.0}}));
  EXPECT_EQ(board_->count("a/x").value(), 2);
  EXPECT_EQ(std::get<double>(value_at("a/x", 5, Method::kBefore)), 3);  // the later of the two
  EXPECT_EQ(std::get<std::string>(value_at("a/y", 5, Method::kBefore)), "one");
  EXPECT_TRUE(board_->put_batch({}).ok());
}

TEST_P(BlackboardContract, TakesNothingOfABatchThatItRefuses) {
  fill();
  const auto refuse = [&](std::vector<PathEntry> batch) { return failure_of(board_->put_batch(std::move(batch))); };
  EXPECT_EQ(refuse({{"new", 1, 1.0}, {"x", 400, 4.0}, {"x", 500, std::string("5")}}), "x: is of type scalar, not text");
  EXPECT_EQ(refuse({{"x", 200, 0.0}, {"new/", 1, 1.0}}), "path 'new/': has an empty segment");
  EXPECT_EQ(refuse({{"new", 1, 1.0}, {"new", 2, std::string("2")}}), "new: is of type scalar, not text");
  EXPECT_THAT(paths(), testing::ElementsAre("x"));
  EXPECT_EQ(board_->count("x").value(), 3);
  EXPECT_EQ(scalar(200, Method::kBefore), 200);
}

TEST_P(BlackboardContract, ASnapshotAnswersEachPathByItsMethod) {
  fill();
  ASSERT_TRUE(board_->put("text", 240, std::string("hello")));
  const std::vector<silpose::Result<Reading>> readings = board_
                                                             ->snapshot(250, {{"x", {Method::kLinear}},
                                                                              {"text", {Method::kHold}},
                                                                              {"nowhere", {Method::kLatest}},
                                                                              {"x", {Method::kAfter}},
                                                                              {"text", {Method::kAfter}}})
                                                             .value();
  ASSERT_EQ(readings.size(), 5u);
  EXPECT_EQ(std::get<double>(readings[0].value().value), 250);
  EXPECT_EQ(readings[0].value().how, How::kInterpolated);
  EXPECT_EQ(std::get<std::string>(readings[1].value().value), "hello");
  EXPECT_EQ(failure_of(readings[2]), "nowhere: no such path");
  EXPECT_EQ(std::get<double>(readings[3].value().value), 300);
  EXPECT_EQ(failure_of(readings[4]), "text: no entry at or after 250 ns");
  EXPECT_TRUE(board_->snapshot(250, {}).value().empty());
}

TEST_P(BlackboardContract, RemovesAPathWithItsSchema) {
  fill();
  ASSERT_TRUE(board_->put("x/below", 0, 1.0));
  ASSERT_TRUE(board_->remove("x"));
  EXPECT_EQ(failure_of(board_->get("x", 0, {Method::kLatest})), "x: no such path");
  EXPECT_THAT(paths(), testing::ElementsAre("x/below"));
  EXPECT_EQ(failure_of(board_->remove("x")), "x: no such path");
  EXPECT_TRUE(board_->put("x", 1, std::string("of another type")).ok());
  EXPECT_EQ(board_->count("x").value(), 1);
}

TEST_P(BlackboardContract, RemovesARangeOfTimeAndKeepsThePath) {
  for (const int64_t t : {kEarliest, int64_t{100}, int64_t{200}, int64_t{300}, kEndOfTime}) {
    ASSERT_TRUE(board_->put("x", t, 1.0));
  }
  EXPECT_EQ(board_->remove_range("x", 101, 199).value(), 0);
  EXPECT_EQ(board_->remove_range("x", 300, 100).value(), 0);
  EXPECT_EQ(board_->remove_range("x", 100, 200).value(), 2);
  EXPECT_EQ(board_->remove_range("x", kEarliest, 299).value(), 1);
  EXPECT_EQ(board_->count("x").value(), 2);
  EXPECT_EQ(board_->list("x").value()[0].first_ns, 300);
  EXPECT_EQ(board_->remove_range("x", kEarliest, kEndOfTime).value(), 2);
  EXPECT_EQ(board_->count("x").value(), 0);
  EXPECT_EQ(failure_of(board_->put("x", 0, std::string("text"))), "x: is of type scalar, not text");
  EXPECT_TRUE(board_->put("x", 0, 2.0).ok());
  EXPECT_EQ(failure_of(board_->remove_range("y", 0, 1)), "y: no such path");
}

}  // namespace sadb
