// Footing: what rests on the floor does not slide. Points of the body that are low and slow in two consecutive poses
// are tied to each other.
// Threads: functions without state.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "silpose/body/collision_spheres.h"
#include "silpose/body/point_motion.h"

namespace silpose {

struct FootContact {
  SkinPoint point;
  double weight = 0;  // metres^-2; those of one bone add up to no more than one foot_contact's
};

// Which of `points`, all that may touch the floor, rest on it from one pose to the next, `dt_s` later: none where one
// of them is well below the floor, whose height is wrong then.
[[nodiscard]] std::vector<FootContact> foot_contacts(std::span<const SkinPoint> points, const PointMotion& motion,
                                                     const PointMotion& next, double dt_s);

// Half the cost's gradient [D] and Hessian [D, D] by two consecutive poses, and across: rows the next, columns the
// first.
struct FootholdEquations {
  Eigen::VectorXd gradient, gradient_next;
  Eigen::MatrixXd hessian, hessian_next, across;
  double cost = 0;
};
[[nodiscard]] FootholdEquations hold(std::span<const FootContact> holds, const PointMotion& motion,
                                     const PointMotion& next, Eigen::Index num_dofs);

}  // namespace silpose
