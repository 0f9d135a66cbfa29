#include "silpose/shape/keypoint_axes.h"

#include <gtest/gtest.h>

namespace silpose {
namespace {

TEST(WorldFromKeypoints, ZIsTheRayOfTheMiddleAndXPointsRightInTheImage) {
  const PinholeCamera camera = look_at_camera(640, 480, 500, {0, 1, 5}, {0, 1, 0});
  Keypoints3D keypoints{.centre_x = camera.cx, .centre_y = camera.cy};
  // A camera that looks level along -Z: right in its image is +X of the world, down is -Y.
  Eigen::Matrix3d level;
  level << 1, 0, 0, 0, -1, 0, 0, 0, -1;
  EXPECT_LT((world_from_keypoints(camera, keypoints) - level).norm(), 1e-9);

  keypoints.centre_x += 500;  // 45 degrees to the right
  const Eigen::Matrix3d right = world_from_keypoints(camera, keypoints);
  EXPECT_LT((right.col(2) - Eigen::Vector3d(1, 0, -1).normalized()).norm(), 1e-9);
  EXPECT_LT((right.col(1) - Eigen::Vector3d(0, -1, 0)).norm(), 1e-9);
}

}  // namespace
}  // namespace silpose
