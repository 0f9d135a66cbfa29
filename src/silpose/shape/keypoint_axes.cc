#include "silpose/shape/keypoint_axes.h"

#include <Eigen/Geometry>

namespace silpose {

Eigen::Matrix3d world_from_keypoints(const PinholeCamera& camera, const Keypoints3D& keypoints) {
  const Eigen::Vector3d ray = camera.ray_from_pixel({keypoints.centre_x, keypoints.centre_y});
  return camera.cam_from_world.rotation.transpose() *
         Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), ray).toRotationMatrix();
}

}  // namespace silpose
