#include "silpose/geometry/rigid3.h"

#include <cmath>

namespace silpose {

double wrap_angle(double radians) {
  const double wrapped = radians - 2 * kPi * std::floor((radians + kPi) / (2 * kPi));
  return wrapped >= kPi ? -kPi : wrapped;  // rounding may land on pi itself
}

}  // namespace silpose
