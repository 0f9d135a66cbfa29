#include "silpose/exchange/unwrapped_euler.h"

#include <cmath>

#include "silpose/geometry/rigid3.h"

namespace silpose {

Eigen::Vector3d SteadyAngles::next(const Eigen::Matrix3d& r) {
  const double cosine = std::hypot(r(2, 0), r(2, 2));
  const double x = std::atan2(r(2, 1), cosine);
  Eigen::Vector3d angles(std::atan2(-r(0, 1), r(1, 1)), x, std::atan2(-r(2, 0), r(2, 2)));
  if (cosine < 1e-9) {
    const double y = previous_.z(), turned = std::atan2(r(1, 0), r(0, 0));  // z + y, or z - y where x is -90 degrees
    angles = {turned - std::copysign(y, x * y), x, y};
  }
  const auto nearest = [&](Eigen::Vector3d set) {
    for (int k = 0; k < 3; ++k) set[k] = previous_[k] + wrap_angle(set[k] - previous_[k]);
    return set;
  };
  const Eigen::Vector3d one = nearest(angles);
  const Eigen::Vector3d other = nearest({angles.x() + kPi, kPi - angles.y(), angles.z() + kPi});
  previous_ = (other - previous_).squaredNorm() < (one - previous_).squaredNorm() ? other : one;
  return previous_;
}

}  // namespace silpose
