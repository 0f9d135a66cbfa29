#include "silpose/geometry/camera.h"

#include <gtest/gtest.h>

#include <cmath>

namespace silpose {
namespace {

PinholeCamera distorted_camera() {
  PinholeCamera camera = look_at_camera(640, 480, 600, {1, 2, 4}, {0.2, 0.9, -0.3});
  camera.fy = 590;
  camera.cx = 331;
  camera.cy = 222;
  camera.distortion = {-0.21, 0.08, 0.002, -0.003, 0.01};
  return camera;
}

TEST(PinholeCamera, ProjectsByHand) {
  PinholeCamera camera;
  camera.width = 640, camera.height = 480;
  camera.fx = 500, camera.fy = 400, camera.cx = 320, camera.cy = 240;
  EXPECT_TRUE(camera.project_from_camera({0.5, -0.25, 2}).isApprox(Eigen::Vector2d(445, 190)));
  // At (0.5, 0.25), r2 = 0.3125: radial = 1 + 0.1 r2 - 0.2 r2^2 + 0.05 r2^3 = 1.013244628906250.
  // x = 0.5 radial + 2 * 0.01 * 0.125 + 0.02 (r2 + 0.5), y = 0.25 radial + 0.01 (r2 + 0.125) + 2 * 0.02 * 0.125.
  camera.distortion = {0.1, -0.2, 0.01, 0.02, 0.05};
  const double radial = 1.01324462890625;
  const Eigen::Vector2d expected(500 * (0.5 * radial + 0.0025 + 0.01625) + 320,
                                 400 * (0.25 * radial + 0.004375 + 0.005) + 240);
  EXPECT_TRUE(camera.project_from_camera({1, 0.5, 2}).isApprox(expected, 1e-12));
}

TEST(PinholeCamera, SeesNothingBehindOrTooNear) {
  const PinholeCamera camera = default_camera(640, 480, 5);
  EXPECT_TRUE(camera.project({0, 1, 0}).has_value());
  EXPECT_FALSE(camera.project({0, 1.5, 5}).has_value());
  EXPECT_FALSE(camera.project({0, 1.5, 4.96}).has_value());
  EXPECT_TRUE(camera.project({0, 1.5, 4.94}).has_value());
  EXPECT_FALSE(camera.project({0, 1.5, 6}).has_value());
}

TEST(PinholeCamera, JacobianMatchesFiniteDifferences) {
  const PinholeCamera camera = distorted_camera();
  const Eigen::Vector3d x(0.4, 1.3, -0.2);
  const auto jacobian = camera.project_jacobian(x);
  const double step = 1e-5;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::Vector3d shift = step * Eigen::Vector3d::Unit(axis);
    const Eigen::Vector2d slope = (*camera.project(x + shift) - *camera.project(x - shift)) / (2 * step);
    EXPECT_LT((jacobian.col(axis) - slope).norm(), 1e-5 * slope.norm());
  }
}

TEST(PinholeCamera, RayIsTheInverseOfProjection) {
  for (const auto& camera : {distorted_camera(), default_camera(641, 333)}) {
    for (int v = 0; v <= camera.height; v += 37) {
      for (int u = 0; u <= camera.width; u += 41) {
        const Eigen::Vector3d ray = camera.ray_from_pixel(Eigen::Vector2d(u, v));
        EXPECT_EQ(ray.z(), 1);
        EXPECT_LT((camera.project_from_camera(2.5 * ray) - Eigen::Vector2d(u, v)).norm(), 1e-8);
      }
    }
  }
}

TEST(PinholeCamera, RayStaysFiniteWhereDistortionFolds) {
  PinholeCamera camera = default_camera(640, 480);
  camera.distortion = {-0.9, 0, 0, 0, 0};
  EXPECT_TRUE(camera.ray_from_pixel({6400, 4800}).allFinite());
}

TEST(PinholeCamera, ResizedSeesTheSamePointAtTheScaledPlace) {
  const PinholeCamera camera = distorted_camera(), half = camera.resized(320, 120);
  const Eigen::Vector3d x(0.1, 1, 0.3);
  const Eigen::Vector2d expected = camera.project(x)->cwiseProduct(Eigen::Vector2d(0.5, 0.25));
  EXPECT_TRUE(half.project(x)->isApprox(expected, 1e-12));
  EXPECT_EQ(half.width, 320);
  EXPECT_EQ(half.height, 120);
}

TEST(DefaultCamera, IsLevelAndSeesTheSubjectsLeftOnTheRight) {
  const PinholeCamera camera = default_camera(640, 480);
  EXPECT_TRUE(camera.centre_in_world().isApprox(Eigen::Vector3d(0, 1.5, 5.5)));
  EXPECT_TRUE(camera.project({0, 1.5, 0})->isApprox(Eigen::Vector2d(320, 240)));
  EXPECT_EQ(camera.fx, 768);
  EXPECT_GT(camera.project({1, 1.5, 0})->x(), 320);
  EXPECT_LT(camera.project({0, 2, 0})->y(), 240);
}

TEST(LookAtCamera, PutsTheTargetInTheMiddleWithYUp) {
  const PinholeCamera camera = look_at_camera(640, 480, 700, {3, 1, -2}, {0, 1.2, 0.5});
  EXPECT_TRUE(camera.centre_in_world().isApprox(Eigen::Vector3d(3, 1, -2), 1e-12));
  EXPECT_TRUE(camera.project({0, 1.2, 0.5})->isApprox(Eigen::Vector2d(320, 240), 1e-9));
  const Eigen::Vector2d above = *camera.project({0, 1.3, 0.5});
  EXPECT_NEAR(above.x(), 320, 1e-9);
  EXPECT_LT(above.y(), 240);
  EXPECT_NEAR(camera.cam_from_world.rotation.determinant(), 1, 1e-12);
  const PinholeCamera down = look_at_camera(640, 480, 700, {0, 3, 0}, {0, 0, 0});
  EXPECT_NEAR(down.cam_from_world.rotation.determinant(), 1, 1e-12);
  EXPECT_THROW(look_at_camera(640, 480, 700, {0, 3, 0}, {0, 3, 0}), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
