// SteadyAngles: one joint's rotation over time as three angles whose curves do not jump.
// Every rotation has two sets of Z, X, Y angles, (z, x, y) and (z + 180, 180 - x, y + 180), and each angle may have
// whole turns added: of all these the set nearest to the frame before is taken, in the first frame the one nearest to
// zero. Threads: a value; one thread.
#pragma once

#include <Eigen/Core>

namespace silpose {

class SteadyAngles {
 public:
  // (z, x, y) in radians with rotation = Rz Rx Ry. Where x is 90 degrees either way, z and y turn about one axis: y
  // stays.
  Eigen::Vector3d next(const Eigen::Matrix3d& rotation);

 private:
  Eigen::Vector3d previous_ = Eigen::Vector3d::Zero();
};

}  // namespace silpose
