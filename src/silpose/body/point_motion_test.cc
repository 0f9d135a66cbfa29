#include "silpose/body/point_motion.h"

#include <gtest/gtest.h>

#include "silpose/base/rng.h"
#include "silpose/body/test_body.h"
#include "silpose/human/human.h"

namespace silpose {
namespace {

void expect_derivatives(const Skeleton& skeleton) {
  Rng rng(3);
  std::vector<double> pose(skeleton.dofs().size());
  for (double& value : pose) value = rng.uniform(-1, 1);
  const PointMotion motion(skeleton, pose);
  const Eigen::Vector3d in_joint(.1, -.2, .3), direction(0.3, -1, 2);
  for (int j = 0; j < skeleton.num_joints(); ++j) {
    const Eigen::Vector3d x = motion.position(j, in_joint);
    const Eigen::Matrix3Xd jacobian = motion.jacobian(j, x);
    Eigen::VectorXd along = Eigen::VectorXd::Ones(skeleton.num_dofs());  // it adds
    motion.add_derivative(j, x, direction, along);
    for (size_t d = 0; d < pose.size(); ++d) {
      constexpr double kStep = 1e-6;
      std::vector<double> plus = pose, minus = pose;
      plus[d] += kStep;
      minus[d] -= kStep;
      const Eigen::Vector3d difference =
          (PointMotion(skeleton, plus).position(j, in_joint) - PointMotion(skeleton, minus).position(j, in_joint)) /
          (2 * kStep);
      const auto column = static_cast<Eigen::Index>(d);
      EXPECT_LT((jacobian.col(column) - difference).norm(), 1e-8) << j << " " << d;
      EXPECT_NEAR(along[column], 1 + direction.dot(difference), 1e-7) << j << " " << d;
    }
  }
}

TEST(PointMotion, DerivativesAgreeWithFiniteDifferences) {
  Rng rng(4);
  std::vector<Eigen::Vector3d> joints;  // of a body of no shape at all
  for (int j = 0; j < 20; ++j) joints.emplace_back(rng.normal(), rng.normal(), rng.normal());
  expect_derivatives(human_skeleton(joints));
  expect_derivatives(make_test_body().skeleton);
}

TEST(PointMotion, RefusesAPoseOfAnotherSize) {
  const Skeleton skeleton = make_test_body().skeleton;
  EXPECT_THROW(PointMotion(skeleton, std::vector<double>(3)), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
