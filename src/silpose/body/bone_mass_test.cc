#include "silpose/body/bone_mass.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "silpose/body/human.h"
#include "silpose/body/point_motion.h"
#include "silpose/body/test_body.h"

namespace silpose {
namespace {

Eigen::Vector3d centre_of(const BodyModel& body) {
  const PointMotion motion(body.skeleton, standing_pose(body));
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const BoneMass& bone : bone_masses(body)) {
    centre += bone.fraction * motion.position(bone.joint_idx, bone.centre_in_joint);
  }
  return centre;
}

TEST(BoneMass, ATubeIsHeavyInItsMiddle) {
  EXPECT_LT((centre_of(make_test_body()) - Eigen::Vector3d(0, 0.75, 0)).norm(), 0.005);
}

TEST(BoneMass, TwoBallsShareTheMass) {
  const std::vector<BoneMass> masses = bone_masses(make_ball_body());
  ASSERT_EQ(masses.size(), 2u);
  for (const BoneMass& ball : masses) {
    EXPECT_NEAR(ball.fraction, 0.5, 0.01);
    EXPECT_LT(ball.centre_in_joint.norm(), 0.005);
  }
}

// A thigh has 0.14 of the mass (hip included), a shin 0.043 (men) and 0.048 (women): deleva1996.
TEST(BoneMass, AHumanIsSpreadAsHumansAre) {
  const BodyModel body = build_human(MakeHumanData::load(SILPOSE_DATA_DIR "/makehuman").value(), {}).value();
  const auto fraction = [&](const char* joint) {
    const auto masses = bone_masses(body);
    const int idx = *body.skeleton.find_joint(joint);
    return std::ranges::find(masses, idx, &BoneMass::joint_idx)->fraction;
  };
  EXPECT_NEAR(fraction("right_thigh"), 0.12, 0.04);
  EXPECT_NEAR(fraction("right_shin"), 0.045, 0.015);
  EXPECT_NEAR(fraction("left_shin"), fraction("right_shin"), 0.001);
  EXPECT_NEAR(centre_of(body).y() / body.height_m, 0.56, 0.02);
}

}  // namespace
}  // namespace silpose
