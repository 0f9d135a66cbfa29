// Keypoints3D: where a network believes the points of a body to be in space, seen in one image. Only their places
// relative to each other are known, and only in the scale of the network's internal body: directions between two points
// are more reliable than distances. Threads: a value.
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

namespace silpose {

struct Keypoint3D {
  std::string name;              // of the joint, or end point, of the body: "left_shin" is the left knee
  std::array<double, 3> x = {};  // metres about the middle between the hips
  double visibility = 1;         // 0 to 1

  static auto members(auto& k) { return std::tie(k.name, k.x, k.visibility); }
};

struct Keypoints3D {
  // A network sees a person in a part of the image as if the camera looked straight at it. The z axis is the ray of
  // this pixel, away from the camera; x points right in the image, y down.
  double centre_x = 0, centre_y = 0;
  std::vector<Keypoint3D> points;

  [[nodiscard]] bool empty() const { return points.empty(); }
  [[nodiscard]] const Keypoint3D* find(std::string_view name) const {
    for (const Keypoint3D& point : points) {
      if (point.name == name) return &point;
    }
    return nullptr;
  }
  static auto members(auto& k) { return std::tie(k.centre_x, k.centre_y, k.points); }
};

}  // namespace silpose
