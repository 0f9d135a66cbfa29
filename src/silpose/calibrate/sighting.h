// What cameras saw of a board that was moved in front of them. Values.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

namespace silpose {

// The board in one image of a camera.
struct Sighting {
  int64_t instant = 0;                   // the same number in all cameras is the same time and place of the board
  std::vector<Eigen::Vector2d> corners;  // [N] pixels, as find_board() gives them
};

// What one camera saw of the board; instants ascend.
struct CameraSightings {
  std::string name;
  int width = 0, height = 0;  // pixels
  std::vector<Sighting> sightings;
};

}  // namespace silpose
