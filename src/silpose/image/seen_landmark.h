// SeenLandmark: a point of the body that was found in a picture. Threads: a value.
#pragma once

#include <string>
#include <tuple>

namespace silpose {

struct SeenLandmark {
  std::string name;       // of the joint, or end point, of the body: "left_shin" is the left knee
  double x = 0, y = 0;    // pixels
  double visibility = 1;  // 0 to 1

  static auto members(auto& l) { return std::tie(l.name, l.x, l.y, l.visibility); }
};

}  // namespace silpose
