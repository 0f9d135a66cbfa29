// person_extent(): where the head and the feet of a person are in a mask. Threads: a function without state.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "silpose/image/mask.h"

namespace silpose {

// Where a mask has its upper and its lower end, pixels (the centre of the top-left pixel at 0.5).
struct PersonExtent {
  double time_s = 0;
  Eigen::Vector2d head;    // middle of what is topmost above the trunk; its uppermost edge
  Eigen::Vector2d feet;    // middle of the legs' lowest part; its lowest edge
  double slenderness = 0;  // height over the square root of the mask's area: less for a person who crouches or sits
  [[nodiscard]] double height() const { return feet.y() - head.y(); }
};

// Its time is left to the caller. Nothing where the mask is empty, is cut by the image's edge, is under 24 pixels
// high, or is much wider than high.
[[nodiscard]] std::optional<PersonExtent> person_extent(const Mask& mask);

}  // namespace silpose
