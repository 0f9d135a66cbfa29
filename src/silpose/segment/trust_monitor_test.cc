#include "silpose/segment/trust_monitor.h"

#include <gtest/gtest.h>

namespace silpose {
namespace {

Mask square(int side, int x = 20, int y = 20) {
  Mask mask(100, 80);
  for (int v = y; v < y + side; ++v) {
    for (int u = x; u < x + side; ++u) mask.set(u, v);
  }
  return mask;
}

TEST(TrustMonitor, TrustsASteadyMask) {
  TrustMonitor monitor;
  for (int i = 0; i < 30; ++i) {
    const Segmentation result = monitor.judge(square(20 + i % 3));
    EXPECT_EQ(result.trust, 1);
    EXPECT_FALSE(result.nothing_found || result.touches_border || result.area_jumped);
  }
}

TEST(TrustMonitor, NothingFoundIsNotTrusted) {
  TrustMonitor monitor;
  const Segmentation result = monitor.judge(Mask(100, 80));
  EXPECT_TRUE(result.nothing_found);
  EXPECT_FALSE(result.touches_border);
  EXPECT_EQ(result.trust, 0);
}

TEST(TrustMonitor, SeesEveryBorder) {
  for (const auto& [x, y] : {std::pair{0, 20}, {20, 0}, {90, 20}, {20, 70}}) {
    const Segmentation result = TrustMonitor().judge(square(10, x, y));
    EXPECT_TRUE(result.touches_border) << x << " " << y;
    EXPECT_LT(result.trust, 1);
    EXPECT_GT(result.trust, 0);
  }
  EXPECT_FALSE(TrustMonitor().judge(square(10, 1, 1)).touches_border);
}

TEST(TrustMonitor, AJumpIsDoubtedUntilItLasts) {
  TrustMonitor monitor;
  for (int i = 0; i < 20; ++i) (void)monitor.judge(square(20));
  EXPECT_TRUE(monitor.judge(square(30)).area_jumped);
  EXPECT_TRUE(monitor.judge(square(10)).area_jumped);
  EXPECT_FALSE(monitor.judge(square(22)).area_jumped);
  (void)monitor.judge(Mask(100, 80));
  EXPECT_FALSE(monitor.judge(square(20)).area_jumped) << "an empty picture does not move the median";
  int doubted = 0;
  for (int i = 0; i < 20; ++i) doubted += monitor.judge(square(30)).area_jumped ? 1 : 0;
  EXPECT_GE(doubted, 5);
  EXPECT_LE(doubted, 10);
}

}  // namespace
}  // namespace silpose
