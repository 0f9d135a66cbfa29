// Keypoint2D: a point of the body that was found in an image. Threads: a value.
#pragma once

#include <string>
#include <tuple>

namespace silpose {

struct Keypoint2D {
  std::string name;       // of the joint, or end point, of the body: "left_shin" is the left knee
  double x = 0, y = 0;    // pixels
  double visibility = 1;  // 0 to 1

  static auto members(auto& l) { return std::tie(l.name, l.x, l.y, l.visibility); }
};

}  // namespace silpose
