#include "silpose/calibrate/person_extent.h"

#include <gtest/gtest.h>

#include <cmath>

namespace silpose {
namespace {

// A head, a trunk and two legs.
Mask figure() {
  Mask mask(100, 120);
  const auto fill = [&](int x0, int x1, int y0, int y1) {
    for (int y = y0; y < y1; ++y) {
      for (int x = x0; x < x1; ++x) mask.set(x, y);
    }
  };
  fill(46, 54, 10, 24);
  fill(40, 60, 24, 64);
  fill(36, 46, 64, 110);
  fill(54, 64, 64, 110);
  return mask;
}

TEST(PersonExtent, HeadAndFeet) {
  const auto extent = person_extent(figure());
  ASSERT_TRUE(extent);
  EXPECT_NEAR(extent->head.x(), 50, 0.01);
  EXPECT_EQ(extent->head.y(), 10);
  EXPECT_NEAR(extent->feet.x(), 50, 0.01);
  EXPECT_EQ(extent->feet.y(), 110);
  EXPECT_NEAR(extent->slenderness, 100 / std::sqrt(14 * 8 + 40 * 20 + 2 * 46 * 10), 1e-9);
}

TEST(PersonExtent, ARaisedArmIsNoHead) {
  Mask mask = figure();
  for (int y = 2; y < 30; ++y) {
    for (int x = 64; x < 69; ++x) mask.set(x, y);
  }
  for (int x = 60; x < 66; ++x) mask.set(x, 28);
  const auto extent = person_extent(mask);
  ASSERT_TRUE(extent);
  EXPECT_NEAR(extent->head.y(), 10, 1);
  EXPECT_NEAR(extent->head.x(), 50, 2);
}

TEST(PersonExtent, NothingOfWhoIsCutOrLies) {
  EXPECT_FALSE(person_extent(Mask(100, 120)));
  Mask cut = figure();
  cut.set(62, 119);
  EXPECT_FALSE(person_extent(cut));
  Mask lying(200, 60);
  for (int y = 20; y < 50; ++y) {
    for (int x = 10; x < 190; ++x) lying.set(x, y);
  }
  EXPECT_FALSE(person_extent(lying));
}

}  // namespace
}  // namespace silpose
