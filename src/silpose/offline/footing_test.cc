#include "silpose/offline/footing.h"

#include <gtest/gtest.h>

#include "silpose/body/test_body.h"

namespace silpose {
namespace {

using Eigen::VectorXd;

class FootingTest : public ::testing::Test {
 protected:
  PointMotion at(const std::vector<double>& pose) const { return {body_.skeleton, pose}; }
  static std::vector<double> standing(double x, double y = 0) { return {x, 0.5 + y, 0, 0, 0, 0, 0, 0}; }

  BodyModel body_ = make_test_body();
  std::vector<SkinPoint> points_ = outermost_points(body_);
  double dt_s_ = 1.0 / 30;
};

TEST_F(FootingTest, OnlyWhatIsLowAndSlowStands) {
  const auto holds = foot_contacts(points_, at(standing(0)), at(standing(0)), dt_s_);
  ASSERT_EQ(holds.size(), 4u);  // the corners of the tube's end
  double sum = 0;
  for (const FootContact& hold : holds) {
    EXPECT_NEAR(hold.point.x_in_joint.y(), -0.5, 1e-6);
    sum += hold.weight;
  }
  EXPECT_NEAR(sum, 30 / (0.016 * 0.016), 1);
  EXPECT_TRUE(foot_contacts(points_, at(standing(0, 0.1)), at(standing(0, 0.1)), dt_s_).empty());
  EXPECT_TRUE(foot_contacts(points_, at(standing(0)), at(standing(0.1)), dt_s_).empty());
}

TEST_F(FootingTest, NothingStandsOnAFloorThatTheBodyReachesThrough) {
  EXPECT_TRUE(foot_contacts(points_, at(standing(0, -0.5)), at(standing(0, -0.5)), dt_s_).empty());
}

TEST_F(FootingTest, DerivativesAgreeWithFiniteDifferences) {
  const auto holds = foot_contacts(points_, at(standing(0)), at(standing(0.005)), dt_s_);
  ASSERT_FALSE(holds.empty());
  const std::vector<double> pose = {0.1, 0.5, 0, 0.2, 0.3, 0.1, 0, 0}, next = {0.12, 0.51, 0.03, 0.25, 0.3, 0.2, 0, 0};
  const FootholdEquations equations = hold(holds, at(pose), at(next), 8);
  EXPECT_GT(equations.cost, 1);
  for (Eigen::Index d = 0; d < 8; ++d) {
    std::vector<double> more = pose, less = pose, next_more = next, next_less = next;
    const auto i = static_cast<size_t>(d);
    more[i] += 1e-6, less[i] -= 1e-6, next_more[i] += 1e-6, next_less[i] -= 1e-6;
    const FootholdEquations a = hold(holds, at(more), at(next), 8), b = hold(holds, at(less), at(next), 8);
    EXPECT_NEAR(equations.gradient[d], (a.cost - b.cost) / 4e-6, 1);
    const double slope = hold(holds, at(pose), at(next_more), 8).cost - hold(holds, at(pose), at(next_less), 8).cost;
    EXPECT_NEAR(equations.gradient_next[d], slope / 4e-6, 1);
    if (d >= 3) continue;  // translations, in which the slide is linear
    const VectorXd across = (a.gradient_next - b.gradient_next) / 2e-6;
    EXPECT_LT((across - equations.across.col(d)).cwiseAbs().maxCoeff(), 1e-4 * across.cwiseAbs().maxCoeff() + 1e-3);
    EXPECT_LT(((a.gradient - b.gradient) / 2e-6 - equations.hessian.col(d)).head(3).cwiseAbs().maxCoeff(), 1);
  }
}

}  // namespace
}  // namespace silpose
