// SeenHumanTest: a human before a camera, and what a network would find of it. Threads: one.
#pragma once

#include <gtest/gtest.h>

#include <memory>
#include <vector>

#include "silpose/base/rng.h"
#include "silpose/geometry/camera.h"
#include "silpose/human/human_for_test.h"
#include "silpose/image/observation.h"
#include "silpose/shape/keypoint_axes.h"

namespace silpose {

class SeenHumanTest : public testing::Test {
 protected:
  int dof(const char* name) const { return body_->skeleton.find_dof(name).value(); }

  std::vector<double> standing(double heading) const {
    std::vector<double> pose(static_cast<size_t>(body_->skeleton.num_dofs()), 0.0);
    pose[static_cast<size_t>(dof("root_ty"))] = 0.95;
    pose[static_cast<size_t>(dof("root_ry"))] = heading;
    return pose;
  }

  // All joints and end points, off by a deviation of `noise_px`; a mask as large as the body.
  Observation see(const std::vector<double>& pose, double noise_px = 0) const {
    Observation seen{Mask(camera_.width, camera_.height)};
    const auto names = landmark_names(*body_);
    const auto positions = landmark_positions(*body_, pose);
    Rng rng(3, 0, 0);
    Eigen::Vector2d least(1e9, 1e9), most(-1e9, -1e9);
    for (size_t i = 0; i < names.size(); ++i) {
      const Eigen::Vector2d pixel =
          camera_.project(positions[i]).value() + noise_px * Eigen::Vector2d(rng.normal(), rng.normal());
      seen.keypoints_2d.push_back({names[i], pixel.x(), pixel.y()});
      least = least.cwiseMin(pixel), most = most.cwiseMax(pixel);
    }
    const Box box = {static_cast<int>(least.x()), static_cast<int>(least.y()), static_cast<int>(most.x() - least.x()),
                     static_cast<int>(most.y() - least.y())};
    const int width = box.height / 10;  // of a body that covers a tenth of its height squared
    const int middle = box.x + box.width / 2;
    for (int y = box.y; y < box.y + box.height; ++y) {
      for (int x = middle - width / 2; x < middle - width / 2 + width; ++x) seen.mask.set(x, y);
    }
    seen.mask.set(box.x, box.y), seen.mask.set(box.x + box.width - 1, box.y);  // hands
    return seen;
  }

  // The same points in space, as a network has them that looks straight at the middle of the body.
  void add_keypoints(const std::vector<double>& pose, Observation& seen) const {
    const auto names = landmark_names(*body_);
    const auto positions = landmark_positions(*body_, pose);
    const Box box = seen.box();
    seen.keypoints_3d = {box.x + 0.5 * box.width, box.y + 0.5 * box.height, {}};
    const Eigen::Matrix3d keypoints_from_world = world_from_keypoints(camera_, seen.keypoints_3d).transpose();
    for (size_t i = 0; i < names.size(); ++i) {
      const Eigen::Vector3d x = keypoints_from_world * (positions[i] - positions[0]);
      seen.keypoints_3d.points.push_back({names[i], {x.x(), x.y(), x.z()}});
    }
  }

  std::shared_ptr<const BodyModel> body_ = human_for_test();
  PinholeCamera camera_ = default_camera(640, 480);
};

}  // namespace silpose
