#include "silpose/evaluate/interval_coverage.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "silpose/base/rng.h"
#include "silpose/body/test_body.h"

namespace silpose {
namespace {

TEST(IntervalCoverage, CountsByHand) {
  Eigen::MatrixXd errors(4, 2), deviations(4, 2);
  errors << 1, 0, -1.6, 0, 1.7, 5, 0, -5;
  deviations << 1, 0, 1, 1, 1, 1, 0, 3.1;
  EXPECT_THAT(interval_coverage(errors, deviations), testing::ElementsAre(0.75, 0.75));
  EXPECT_THAT(interval_coverage(errors, deviations, 0.5), testing::ElementsAre(0.25, 0.5));
}

TEST(IntervalCoverage, OfAGaussianIsNinetyPercent) {
  Rng rng(7);
  constexpr Eigen::Index kFrames = 20000;
  Eigen::MatrixXd errors(kFrames, 1);
  for (Eigen::Index t = 0; t < kFrames; ++t) errors(t, 0) = 3 * rng.normal();
  EXPECT_NEAR(interval_coverage(errors, Eigen::MatrixXd::Constant(kFrames, 1, 3))[0], 0.9, 0.01);
}

TEST(IntervalCoverage, RefusesOtherShapes) {
  EXPECT_THROW((void)interval_coverage(Eigen::MatrixXd(2, 2), Eigen::MatrixXd(2, 3)), std::invalid_argument);
  EXPECT_THROW((void)interval_coverage(Eigen::MatrixXd(0, 2), Eigen::MatrixXd(0, 2)), std::invalid_argument);
}

TEST(PoseDifference, WrapsPeriodicDofsOnly) {
  const BodyModel body = make_test_body();
  std::vector<double> pose(8, 0.0), truth(8, 0.0);
  pose[0] = 5, pose[3] = to_radians(170), truth[3] = to_radians(-170);
  const std::vector<double> difference = pose_difference(body.skeleton, pose, truth);
  EXPECT_NEAR(difference[0], 5, 1e-12);
  EXPECT_NEAR(to_degrees(difference[3]), -20, 1e-9);
  EXPECT_THROW((void)pose_difference(body.skeleton, pose, std::vector<double>(7)), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
