#include "silpose/geometry/rigid3.h"

#include <gtest/gtest.h>

#include <cmath>

namespace silpose {
namespace {

TEST(Rigid3, ComposesAndInverts) {
  const Rigid3 b_from_a{Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix(), {1, -2, 3}};
  const Rigid3 c_from_b{Eigen::AngleAxisd(-1.9, Eigen::Vector3d::UnitY()).toRotationMatrix(), {0.5, 0, 4}};
  const Eigen::Vector3d x(0.3, 0.2, -5);
  EXPECT_TRUE(((c_from_b * b_from_a) * x).isApprox(c_from_b * (b_from_a * x), 1e-12));
  EXPECT_TRUE((b_from_a.inverse() * (b_from_a * x)).isApprox(x, 1e-12));
}

TEST(WrapAngle, LandsInTheHalfOpenTurn) {
  EXPECT_EQ(wrap_angle(0), 0);
  EXPECT_EQ(wrap_angle(kPi), -kPi);
  EXPECT_EQ(wrap_angle(-kPi), -kPi);
  for (int k = -300; k <= 300; ++k) {
    const double angle = 0.21 * k, wrapped = wrap_angle(angle);
    EXPECT_GE(wrapped, -kPi);
    EXPECT_LT(wrapped, kPi);
    EXPECT_NEAR(std::remainder(angle - wrapped, 2 * kPi), 0, 1e-9);
  }
  const double just_below = std::nextafter(-kPi, -4.0);
  EXPECT_GE(wrap_angle(just_below), -kPi);
  EXPECT_LT(wrap_angle(just_below), kPi);
}

}  // namespace
}  // namespace silpose
