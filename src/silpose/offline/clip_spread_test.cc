#include "silpose/offline/clip_spread.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "silpose/body/test_body.h"
#include "silpose/geometry/rigid3.h"

namespace silpose {
namespace {

using testing::DoubleNear;
using testing::ElementsAre;
using testing::IsEmpty;

TEST(WeightsBeside, AreLikelihoodsThatSumToOneWithTheSmoothedPose) {
  // Likelihoods 1, 1 / 2 and e^-1 / 2, of two passes.
  const double sum = 1 + 0.5 + 0.5 * std::exp(-1);
  EXPECT_THAT(weights_beside(7, std::vector<double>{7, 9}, 2),
              ElementsAre(DoubleNear(0.5 / sum, 1e-15), DoubleNear(0.5 * std::exp(-1) / sum, 1e-15)));
  EXPECT_THAT(weights_beside(7, {}, 3), IsEmpty());
}

TEST(WeightsBeside, AHypothesisThatFitsBetterOutweighsTheSmoothedPose) {
  const double of_smoothed = std::exp(-5);
  EXPECT_THAT(weights_beside(20, std::vector<double>{10}, 1), ElementsAre(DoubleNear(1 / (1 + of_smoothed), 1e-15)));
  // Energies of thousands do not underflow.
  EXPECT_THAT(weights_beside(5000, std::vector<double>{4000, 1e6}, 1),
              ElementsAre(DoubleNear(1, 1e-15), DoubleNear(0, 1e-15)));
}

TEST(AddDisagreement, AddsTheWeightedVarianceAboutTheSmoothedPose) {
  const BodyModel body = make_test_body();
  std::vector<double> smoothed(8, 0.0);
  smoothed[0] = 0.1, smoothed[3] = to_radians(175);
  Eigen::VectorXd a = Eigen::VectorXd::Zero(8), b = Eigen::VectorXd::Zero(8), ignored = Eigen::VectorXd::Zero(8);
  a[0] = 0.3, a[3] = to_radians(-175);  // periodic: 10 degrees away
  b[0] = -0.2, b[3] = to_radians(170);
  ignored[0] = 1000;
  PoseVariances sum = no_variances(8, body);
  sum.dofs[0] = 0.01;  // of the fit
  add_disagreement(body, smoothed, std::vector{a, b, ignored}, std::vector<double>{0.2, 0.4, 1e-9}, sum);
  EXPECT_NEAR(sum.dofs[0], 0.01 + 0.2 * 0.04 + 0.4 * 0.09, 1e-12);
  EXPECT_NEAR(sum.dofs[3], 0.2 * std::pow(to_radians(10), 2) + 0.4 * std::pow(to_radians(5), 2), 1e-12);
  EXPECT_EQ(sum.dofs[5], 0);
  EXPECT_NEAR(sum.landmarks.in_world[0].x(), 0.2 * 0.04 + 0.4 * 0.09, 1e-12);
  EXPECT_NEAR(sum.landmarks.about_root[0].norm(), 0, 1e-15);
}

}  // namespace
}  // namespace silpose
