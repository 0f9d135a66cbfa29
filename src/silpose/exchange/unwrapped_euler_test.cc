#include "silpose/exchange/unwrapped_euler.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include "silpose/base/rng.h"
#include "silpose/geometry/rigid3.h"

namespace silpose {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

Matrix3d rotation(double z, double x, double y) {
  return (AngleAxisd(z, Vector3d::UnitZ()) * AngleAxisd(x, Vector3d::UnitX()) * AngleAxisd(y, Vector3d::UnitY()))
      .toRotationMatrix();
}

TEST(SteadyAngles, AreThoseOfTheRotation) {
  Rng rng(3);
  for (int i = 0; i < 200; ++i) {
    const Matrix3d turned = rotation(rng.uniform(-9, 9), rng.uniform(-9, 9), rng.uniform(-9, 9));
    const Vector3d angles = SteadyAngles().next(turned);
    EXPECT_LT((rotation(angles[0], angles[1], angles[2]) - turned).norm(), 1e-12);
  }
}

TEST(SteadyAngles, GoOnPastWholeTurnsAndPastARightAngle) {
  for (int axis = 0; axis < 3; ++axis) {
    SteadyAngles steady;
    for (int frame = 0; frame < 200; ++frame) {
      Vector3d wanted(0.05, 0.05, 0.05);
      wanted[axis] = 0.1 * frame;
      EXPECT_LT((steady.next(rotation(wanted[0], wanted[1], wanted[2])) - wanted).norm(), 1e-9) << axis << " " << frame;
    }
  }
}

TEST(SteadyAngles, ArePlainInTheFirstFrame) {
  // The same rotation as (180, 60, 180) degrees.
  EXPECT_LT((SteadyAngles().next(rotation(0, to_radians(120), 0)) - Vector3d(0, to_radians(120), 0)).norm(), 1e-9);
}

TEST(SteadyAngles, KeepTheTwistWhereItIsUndetermined) {
  for (const double sign : {1.0, -1.0}) {
    SteadyAngles steady;
    for (const double x : {0.0, 1.0, kPi / 2}) {
      const Vector3d angles = steady.next(rotation(0.4, sign * x, -0.3));
      EXPECT_LT((angles - Vector3d(0.4, sign * x, -0.3)).norm(), 1e-7) << sign << " " << x;
    }
  }
}

}  // namespace
}  // namespace silpose
