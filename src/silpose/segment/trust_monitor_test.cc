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
    const Observation result = monitor.judge(square(20 + i % 3));
    EXPECT_EQ(result.trust.overall, 1);
    EXPECT_FALSE(result.trust.nothing_found || result.trust.touches_border || result.trust.area_jumped);
  }
}

TEST(TrustMonitor, NothingFoundIsNotTrusted) {
  TrustMonitor monitor;
  const Observation result = monitor.judge(Mask(100, 80));
  EXPECT_TRUE(result.trust.nothing_found);
  EXPECT_FALSE(result.trust.touches_border);
  EXPECT_EQ(result.trust.overall, 0);
}

TEST(TrustMonitor, SeesEveryBorder) {
  for (const auto& [x, y] : {std::pair{0, 20}, {20, 0}, {90, 20}, {20, 70}}) {
    const Observation result = TrustMonitor().judge(square(10, x, y));
    EXPECT_TRUE(result.trust.touches_border) << x << " " << y;
    EXPECT_LT(result.trust.overall, 1);
    EXPECT_GT(result.trust.overall, 0);
  }
  EXPECT_FALSE(TrustMonitor().judge(square(10, 1, 1)).trust.touches_border);
}

TEST(TrustMonitor, AJumpIsDoubtedUntilItLasts) {
  TrustMonitor monitor;
  for (int i = 0; i < 20; ++i) (void)monitor.judge(square(20));
  EXPECT_TRUE(monitor.judge(square(30)).trust.area_jumped);
  EXPECT_TRUE(monitor.judge(square(10)).trust.area_jumped);
  EXPECT_FALSE(monitor.judge(square(22)).trust.area_jumped);
  (void)monitor.judge(Mask(100, 80));
  EXPECT_FALSE(monitor.judge(square(20)).trust.area_jumped) << "an empty image does not move the median";
  int doubted = 0;
  for (int i = 0; i < 20; ++i) doubted += monitor.judge(square(30)).trust.area_jumped ? 1 : 0;
  EXPECT_GE(doubted, 5);
  EXPECT_LE(doubted, 10);
}

TEST(TrustMonitor, HidingBehindIgnoredPixelsIsNoJump) {
  Mask post(100, 80);
  for (int y = 0; y < 80; ++y) {
    for (int x = 40; x < 50; ++x) post.set(x, y);
  }
  TrustMonitor monitor(std::make_shared<const Mask>(post));
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(monitor.judge(square(20, 2, 20)).trust.area_jumped);
  Mask half(100, 80);
  for (int y = 20; y < 40; ++y) {
    for (int x = 34; x < 40; ++x) half.set(x, y);
  }
  const Observation seen = monitor.judge(half);
  EXPECT_FALSE(seen.trust.area_jumped);
  EXPECT_EQ(seen.trust.overall, 1);
  EXPECT_EQ(seen.ignored, monitor.ignored());
  EXPECT_TRUE(monitor.judge(square(9, 2, 20)).trust.area_jumped) << "in the open";
}

}  // namespace
}  // namespace silpose
