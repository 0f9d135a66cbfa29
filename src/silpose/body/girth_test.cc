#include "silpose/body/girth.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "silpose/body/human.h"
#include "silpose/body/test_body.h"

namespace silpose {
namespace {

Eigen::Vector3f extent(const BodyModel& body) {
  Eigen::Vector3f lowest = body.rest.vertices.front(), highest = lowest;
  for (const Eigen::Vector3f& x : body.rest.vertices) lowest = lowest.cwiseMin(x), highest = highest.cwiseMax(x);
  return highest - lowest;
}

TEST(Girth, MakesATubeThickerAndNoLonger) {
  const BodyModel tube = make_test_body();
  ASSERT_EQ(girth_names(tube), (std::vector<std::string>{"root", "middle", "tip"}));
  const BodyModel thicker = with_girths(tube, std::vector<double>(3, 0.1));
  EXPECT_LT((extent(thicker) - Eigen::Vector3f(0.33f, 1.5f, 0.33f)).norm(), 1e-4);
  EXPECT_NEAR(volume(thicker.rest) / volume(tube.rest), 1.21, 1e-3);
  EXPECT_NEAR(thicker.weight_kg, 1.21 * tube.weight_kg, 1e-3 * tube.weight_kg);
}

TEST(Girth, OfAHumanAreOneForBothSidesAndLeaveOtherBonesAlone) {
  const BodyModel human = build_human(MakeHumanData::load(SILPOSE_DATA_DIR "/makehuman").value(), {}).value();
  const std::vector<std::string> names = girth_names(human);
  const auto thigh = std::ranges::find(names, "thigh");
  ASSERT_NE(thigh, names.end());
  EXPECT_EQ(std::ranges::count(names, "thigh"), 1);
  std::vector<double> girths(names.size(), 0);
  girths[static_cast<size_t>(thigh - names.begin())] = 0.2;
  const BodyModel thicker = with_girths(human, girths);
  const auto joint_of = [&](size_t v) {
    const auto begin = human.skin.weight.begin() + human.skin.row_start[v];
    const auto end = human.skin.weight.begin() + human.skin.row_start[v + 1];
    return *std::max_element(begin, end) == 1
               ? human.skeleton.joints()[human.skin.joint_idx[static_cast<size_t>(begin - human.skin.weight.begin())]]
                     .name
               : "";
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
  EXPECT_THROW((void)with_girths(make_test_body(), std::vector<double>(2, 0)), std::invalid_argument);
  EXPECT_THROW((void)with_girths(make_test_body(), std::vector<double>(3, -1)), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
