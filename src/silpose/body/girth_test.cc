#include "silpose/body/girth.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "silpose/body/test_body.h"
#include "silpose/human/human_for_test.h"

namespace silpose {
namespace {

Eigen::Vector3f extent(const BodyModel& body) {
  Eigen::Vector3f lowest = body.rest.vertices.front(), highest = lowest;
  for (const Eigen::Vector3f& x : body.rest.vertices) lowest = lowest.cwiseMin(x), highest = highest.cwiseMax(x);
  return highest - lowest;
}

TEST(Girth, MakesATubeThickerAndNoLonger) {
  const BodyModel tube = make_test_body();
  ASSERT_EQ(Girths(tube).names(), (std::vector<std::string>{"root", "middle", "tip"}));
  const BodyModel thicker = Girths(tube).applied(std::vector<double>(3, 0.1));
  EXPECT_LT((extent(thicker) - Eigen::Vector3f(0.33f, 1.5f, 0.33f)).norm(), 1e-4);
  EXPECT_NEAR(volume(thicker.rest) / volume(tube.rest), 1.21, 1e-3);
  EXPECT_NEAR(thicker.weight_kg, 1.21 * tube.weight_kg, 1e-3 * tube.weight_kg);
}

TEST(Girth, OfAHumanAreOneForBothSidesAndLeaveOtherBonesAlone) {
  const BodyModel& human = *human_for_test();
  const Girths of_human(human);
  const std::vector<std::string>& names = of_human.names();
  const auto thigh = std::ranges::find(names, "thigh");
  ASSERT_NE(thigh, names.end());
  EXPECT_EQ(std::ranges::count(names, "thigh"), 1);
  std::vector<double> girths(names.size(), 0);
  girths[static_cast<size_t>(thigh - names.begin())] = 0.2;
  const BodyModel thicker = of_human.applied(girths);
  // Vertices of one bone alone.
  const std::vector<int> main_joint = main_joints(human);
  const auto joint_of = [&](size_t v) -> std::string {
    if (human.skin.row_start[v + 1] - human.skin.row_start[v] > 1) return "";
    return human.skeleton.joints()[static_cast<size_t>(main_joint[v])].name;
  };
  int right = 0, left = 0;
  for (size_t v = 0; v < human.rest.vertices.size(); ++v) {
    const float moved = (thicker.rest.vertices[v] - human.rest.vertices[v]).norm();
    if (joint_of(v) == "right_thigh" && moved > 0.01f) ++right;
    if (joint_of(v) == "left_thigh" && moved > 0.01f) ++left;
    if (joint_of(v) == "head") {
      EXPECT_EQ(moved, 0);
    }
  }
  EXPECT_GT(right, 20);
  EXPECT_NEAR(right, left, 0.1 * right);
  EXPECT_GT(thicker.weight_kg, human.weight_kg + 1);
}

TEST(Girth, RefusesWhatIsNoGirth) {
  EXPECT_THROW((void)Girths(make_test_body()).applied(std::vector<double>(2, 0)), std::invalid_argument);
  EXPECT_THROW((void)Girths(make_test_body()).applied(std::vector<double>(3, -1)), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
