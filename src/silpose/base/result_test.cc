#include "silpose/base/result.h"

#include <gtest/gtest.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>

#include "silpose/base/check.h"

namespace silpose {
namespace {

Result<int> half(int number) {
  if (number % 2 != 0) return error("{}: not even", number);
  return number / 2;
}

Result<std::string> quarter(int number) {
  const Result<int> first = half(number);
  if (!first) return first.failure();
  const Result<int> second = half(*first);
  if (!second) return second.failure();
  return std::to_string(*second);
}

TEST(Result, HoldsAValueOrAReason) {
  EXPECT_TRUE(half(6).ok());
  EXPECT_EQ(half(6).value(), 3);
  EXPECT_FALSE(half(7).ok());
  EXPECT_EQ(half(7).error().message, "7: not even");
}

TEST(Result, FailurePassesThroughOtherTypes) {
  EXPECT_EQ(*quarter(12), "3");
  EXPECT_EQ(quarter(6).error().message, "3: not even");
}

TEST(Result, ValueThrowsTheMessage) {
  const auto message = [](const auto& call) -> std::string {
    try {
      call();
    } catch (const std::runtime_error& failure) {
      return failure.what();
    }
    return "nothing thrown";
  };
  Result<int> kept = half(5);
  const Result<int> constant = half(5);
  EXPECT_EQ(message([&] { (void)kept.value(); }), "5: not even");
  EXPECT_EQ(message([&] { (void)constant.value(); }), "5: not even");
  EXPECT_EQ(message([&] { (void)half(5).value(); }), "5: not even");
  EXPECT_EQ(message([&] { Result<void>(Error{"disk full"}).value(); }), "disk full");
  EXPECT_EQ(message([&] { (void)half(4).value(); }), "nothing thrown");
}

TEST(Result, TemporaryGivesItsValueAway) {
  const auto make = [] { return Result<std::unique_ptr<int>>(std::make_unique<int>(4)); };
  const std::unique_ptr<int> taken = make().value();
  EXPECT_EQ(*taken, 4);
  static_assert(std::is_same_v<decltype(make().value()), std::unique_ptr<int>>, "a temporary returns by value");
  const std::unique_ptr<int>& kept = *make();
  EXPECT_EQ(*kept, 4);
  static_assert(std::is_same_v<decltype(*make()), std::unique_ptr<int>>);
  static_assert(std::is_same_v<decltype(make().error()), Error>);
}

TEST(Result, OfNothing) {
  const auto write = [](bool works) -> Result<void> {
    if (!works) return error("out.csv: cannot be written");
    return {};
  };
  EXPECT_TRUE(write(true));
  EXPECT_NO_THROW(write(true).value());
  EXPECT_EQ(write(false).error().message, "out.csv: cannot be written");
  const Result<int> passed = write(false).failure();
  EXPECT_EQ(passed.error().message, "out.csv: cannot be written");
}

TEST(Check, ThrowsTheValues) {
  EXPECT_NO_THROW(check(true, "never {}", 1));
  try {
    check(false, "width is {}", -3);
    FAIL() << "nothing thrown";
  } catch (const std::invalid_argument& failure) {
    EXPECT_STREQ(failure.what(), "width is -3");
  }
}

}  // namespace
}  // namespace silpose
