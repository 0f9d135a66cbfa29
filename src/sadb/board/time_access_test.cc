#include "sadb/board/time_access.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "sadb/board/blackboard.h"

namespace sadb {
namespace {

using silpose::ByteImage;
using silpose::Mask;
using silpose::Result;
using silpose::Rigid3;
using silpose::to_radians;

Rigid3 turn(double degrees, double x) {
  return {Eigen::AngleAxisd(to_radians(degrees), Eigen::Vector3d::UnitY()).toRotationMatrix(), {x, 0, 0}};
}

Result<Reading> between(const Entry& before, const Entry& after, int64_t time_ns, Method method) {
  return read_at({&before, &after, &after}, time_ns, {method}, {type_of(before.value)});
}

TEST(ReadAt, InterpolatesNumbersVectorsAndPoses) {
  const Result<Reading> scalar = between({100, 1.0}, {200, 3.0}, 125, Method::kLinear);
  EXPECT_DOUBLE_EQ(std::get<double>(scalar->value), 1.5);
  EXPECT_EQ(scalar->how, How::kInterpolated);
  EXPECT_EQ(scalar->time_ns, 125);
  EXPECT_EQ(scalar->from_ns, 100);
  EXPECT_EQ(scalar->to_ns, 200);
  const auto vector = between({100, std::vector{1.0, 8.0}}, {200, std::vector{3.0, 0.0}}, 125, Method::kLinear);
  EXPECT_EQ(std::get<std::vector<double>>(vector->value), (std::vector{1.5, 6.0}));
  const auto pose = between({0, Pose{"human", {0, 1}}}, {10, Pose{"human", {1, 2}}}, 5, Method::kLinear);
  EXPECT_EQ(std::get<Pose>(pose->value), (Pose{"human", {0.5, 1.5}}));
}

TEST(ReadAt, InterpolatesTransformsOnTheShortArc) {
  const auto reading = between({0, turn(170, 0)}, {10, turn(-150, 1)}, 5, Method::kLinear);
  const Rigid3& middle = std::get<Rigid3>(reading->value);
  EXPECT_TRUE(middle.rotation.isApprox(turn(-170, 0).rotation, 1e-12));
  EXPECT_NEAR(middle.translation.x(), 0.5, 1e-12);
}

TEST(ReadAt, SaysWhatCannotBeInterpolated) {
  const auto fails = [](Value a, Value b) {
    const auto reading = between({0, std::move(a)}, {10, std::move(b)}, 5, Method::kLinear);
    return reading.ok() ? std::string("it can") : reading.error().message;
  };
  EXPECT_EQ(fails(std::string("a"), std::string("b")), "type text cannot be interpolated");
  EXPECT_EQ(fails(Json{"{}"}, Json{"{}"}), "type json cannot be interpolated");
  EXPECT_EQ(fails(ByteImage(1, 1), ByteImage(1, 1)), "type image cannot be interpolated");
  EXPECT_EQ(fails(Mask(), Mask()), "type mask cannot be interpolated");
  EXPECT_EQ(fails(std::vector{1.0}, std::vector{1.0, 2.0}), "vectors of 1 and 2 numbers cannot be interpolated");
  EXPECT_NE(fails(Pose{"human", {1}}, Pose{"snake", {1}}), "it can");
  EXPECT_NE(fails(1.0, std::string("b")), "it can");
}

TEST(ReadAt, LinearAtAnEntryIsTheEntryOfAnyType) {
  const Entry text{5, std::string("now")};
  const auto reading = read_at({&text, &text, &text}, 5, {Method::kLinear}, {Type::kText});
  EXPECT_EQ(std::get<std::string>(reading->value), "now");
  EXPECT_EQ(reading->how, How::kRecorded);
}

TEST(ReadAt, InterpolatesPeriodicValuesOnTheShortArc) {
  const Schema schema{Type::kPose, PoseSchema{"wheel", {{"turn", PoseDof::Kind::kRotation, "deg", 360}}}};
  const auto turn_at = [&](double before, double after, int64_t time_ns) {
    const Entry first{0, Pose{"wheel", {before}}}, second{10, Pose{"wheel", {after}}};
    return std::get<Pose>(read_at({&first, &second, &second}, time_ns, {Method::kLinear}, schema)->value).values[0];
  };
  EXPECT_NEAR(turn_at(179, -179, 5), 180, 1e-12);
  EXPECT_NEAR(turn_at(-179, 179, 5), -180, 1e-12);
  EXPECT_NEAR(turn_at(350, 20, 2), 356, 1e-12);
  EXPECT_NEAR(turn_at(10, 730, 5), 10, 1e-12);  // two whole turns are none
  EXPECT_EQ(turn_at(10, 50, 5), 30);
  EXPECT_EQ(turn_at(0, 180, 5), 90);  // both ways are equally short: the way of the numbers
  EXPECT_EQ(turn_at(0, -180, 5), -90);
  EXPECT_EQ(turn_at(90, -90, 5), 0);
  const Entry wide{0, Pose{"wheel", {1, 2}}}, wider{10, Pose{"wheel", {3, 4}}};
  EXPECT_THROW((void)read_at({&wide, &wider, &wider}, 5, {Method::kLinear}, schema), std::invalid_argument);
}

TEST(ReadAt, SurvivesTheEndsOfTime) {
  const int64_t first = std::numeric_limits<int64_t>::min(), last = std::numeric_limits<int64_t>::max();
  EXPECT_NEAR(std::get<double>(between({first, 0.0}, {last, 1.0}, 0, Method::kLinear)->value), 0.5, 1e-12);
  EXPECT_EQ(between({first, 0.0}, {last, 1.0}, 1, Method::kNearest)->time_ns, last);
  EXPECT_EQ(between({first, 0.0}, {last, 1.0}, -1, Method::kNearest)->time_ns, first);
}

TEST(MethodNames, GoThereAndBack) {
  for (const char* name : {"latest", "nearest", "before", "after", "hold", "linear"}) {
    EXPECT_EQ(method_name(*parse_method(name)), name);
  }
  EXPECT_EQ(parse_method("psychic").error().message,
            "method 'psychic': not one of latest, nearest, before, after, hold, linear");
  EXPECT_EQ(how_name(How::kHeld), "held");
}

TEST(TypeNames, FollowTheAlternatives) {
  EXPECT_EQ(type_name(type_of(1.0)), "scalar");
  EXPECT_EQ(type_name(type_of(std::string("x"))), "text");
  EXPECT_EQ(type_name(type_of(Rigid3{})), "transform");
  EXPECT_EQ(type_name(type_of(Pose{})), "pose");
  EXPECT_EQ(type_name(type_of(Mask())), "mask");
}

TEST(SharedPayload, IsOneObjectInAllCopies) {
  const Shared<Mask> mask = silpose::mask_from_text("#.");
  const Value value = mask, copy = value;
  EXPECT_EQ(&*std::get<Shared<Mask>>(copy), &*mask);
  EXPECT_EQ(mask, Shared<Mask>(silpose::mask_from_text("#.")));
  EXPECT_FALSE(mask == Shared<Mask>(silpose::mask_from_text(".#")));
  EXPECT_EQ(Shared<Mask>()->width(), 0);
}

TEST(CheckPath, TakesSegmentsAndNothingElse) {
  EXPECT_TRUE(check_path("pose").ok());
  EXPECT_TRUE(check_path("tracker/pose 2/x").ok());
  for (const char* bad : {"", "/", "/pose", "pose/", "a//b", "a\nb", "a\x7f"})
    EXPECT_FALSE(check_path(bad).ok()) << bad;
}

TEST(IsAtOrBelow, GoesByWholeSegments) {
  EXPECT_TRUE(is_at_or_below("a/b", ""));
  EXPECT_TRUE(is_at_or_below("a/b", "a"));
  EXPECT_TRUE(is_at_or_below("a/b", "a/"));
  EXPECT_TRUE(is_at_or_below("a/b", "a/b"));
  EXPECT_FALSE(is_at_or_below("ab", "a"));
  EXPECT_FALSE(is_at_or_below("a", "a/b"));
}

}  // namespace
}  // namespace sadb
