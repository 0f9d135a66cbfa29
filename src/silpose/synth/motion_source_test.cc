#include "silpose/synth/motion_source.h"

#include <gmock/gmock.h>

#include <cmath>

#include "silpose/body/test_body.h"
#include "silpose/human/human_for_test.h"

namespace silpose {
namespace {

using testing::HasSubstr;

const BodyModel& human() { return *human_for_test(2000); }

void expect_inside_limits(const Skeleton& skeleton, const std::vector<std::vector<double>>& poses) {
  for (const auto& pose : poses) {
    std::vector<double> inside = pose;
    skeleton.clamp(inside);
    for (size_t d = 0; d < pose.size(); ++d) EXPECT_NEAR(pose[d], inside[d], 1e-9) << skeleton.dofs()[d].name;
  }
}

TEST(Motion, StaticPosesFollowTheSeedAndStandOnTheFloor) {
  const BodyModel& body = human();
  const auto a = draw_static_pose(body, 1), b = draw_static_pose(body, 1), c = draw_static_pose(body, 2);
  EXPECT_EQ(a, b);
  double squares = 0;
  for (size_t d = 6; d < a.size(); ++d) squares += std::pow(to_degrees(a[d] - c[d]), 2);
  EXPECT_GT(std::sqrt(squares), 30);
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    const auto pose = draw_static_pose(body, seed);
    EXPECT_NEAR(lowest_point(body, pose), 0, 1e-6);
    squares = 0;
    for (size_t d = 6; d < pose.size(); ++d) squares += std::pow(to_degrees(pose[d]), 2);
    EXPECT_GT(std::sqrt(squares), 60) << "seed " << seed;
    expect_inside_limits(body.skeleton, {pose});
  }
}

TEST(Motion, SweepsOneDofOverItsWholeRange) {
  const BodyModel& body = human();
  const int d = body.skeleton.find_dof("left_forearm_rx").value();
  SyntheticMotionOptions options;
  options.num_frames = 60;
  const SyntheticMotion motion = make_motion("dof:" + std::to_string(d), body, options).value();
  ASSERT_EQ(motion.poses.size(), 60u);
  const Dof& dof = body.skeleton.dofs()[static_cast<size_t>(d)];
  EXPECT_NEAR(motion.poses[0][static_cast<size_t>(d)], dof.lower, 1e-12);
  EXPECT_NEAR(motion.poses[30][static_cast<size_t>(d)], dof.upper, 1e-12);
  for (size_t other = 0; other < 37; ++other) {
    if (static_cast<int>(other) != d) {
      EXPECT_EQ(motion.poses[0][other], motion.poses[30][other]);
    }
  }
  EXPECT_GT(motion.poses[0][1], 0.7);  // the pelvis of a standing adult
}

TEST(Motion, SwayKeepsTheAnklesInPlace) {
  const BodyModel& body = human();
  const SyntheticMotion motion = make_motion("sway", body).value();
  ASSERT_EQ(motion.poses.size(), 80u);
  expect_inside_limits(body.skeleton, motion.poses);
  const auto left = static_cast<size_t>(body.skeleton.find_joint("left_foot").value());
  const auto right = static_cast<size_t>(body.skeleton.find_joint("right_foot").value());
  for (const auto& pose : motion.poses) {
    const auto joints = body.skeleton.forward_kinematics(pose);
    EXPECT_NEAR((joints[left].translation.x() + joints[right].translation.x()) / 2, 0, 1e-9);
    EXPECT_NEAR(lowest_point(body, pose), 0, 1e-6);
  }
  EXPECT_GT(std::abs(motion.poses[30][static_cast<size_t>(body.skeleton.find_dof("root_rz").value())]), to_radians(7));
}

TEST(Motion, CircleGoesRoundFacingWhereItGoes) {
  const BodyModel& body = human();
  SyntheticMotionOptions options;
  options.num_frames = 181;
  const SyntheticMotion motion = make_motion("circle", body, options).value();
  expect_inside_limits(body.skeleton, motion.poses);
  const auto heading = static_cast<size_t>(body.skeleton.find_dof("root_ry").value());
  for (size_t t = 0; t + 1 < motion.poses.size(); ++t) {
    const auto &a = motion.poses[t], &b = motion.poses[t + 1];
    EXPECT_NEAR(std::hypot(a[0], a[2]), 1, 1e-9);
    EXPECT_NEAR(wrap_angle(std::atan2(b[0] - a[0], b[2] - a[2]) - a[heading]), 0, 0.05);
  }
  EXPECT_NEAR(motion.poses[180][0], motion.poses[0][0], 1e-9);
  EXPECT_NEAR(motion.poses[180][2], motion.poses[0][2], 1e-9);
}

TEST(Motion, RandomIsSmoothAndFollowsTheSeed) {
  const BodyModel& body = human();
  SyntheticMotionOptions options;
  const auto one = random_smooth(body, options), again = random_smooth(body, options);
  EXPECT_EQ(one, again);
  options.seed = 2;
  EXPECT_NE(one, random_smooth(body, options));
  expect_inside_limits(body.skeleton, one);
  for (size_t t = 1; t < one.size(); ++t) {
    for (size_t d = 3; d < 37; ++d) EXPECT_LT(std::abs(wrap_angle(one[t][d] - one[t - 1][d])), to_radians(5));
  }
}

TEST(Motion, WorksOnOtherBodies) {
  const BodyModel body = make_test_body();
  for (const char* name : {"static", "sway", "circle", "random", "dof:4"}) {
    const SyntheticMotion motion = make_motion(name, body).value();
    ASSERT_EQ(motion.poses.size(), 80u) << name;
    ASSERT_EQ(motion.poses[0].size(), 8u) << name;
    expect_inside_limits(body.skeleton, motion.poses);
  }
}

TEST(Motion, NamesWhatItDoesNotKnow) {
  const BodyModel body = make_test_body();
  const auto message = [&](const char* name) { return make_motion(name, body).error().message; };
  EXPECT_THAT(message("hop"), HasSubstr("unknown motion 'hop'"));
  EXPECT_EQ(message("dof:8"), "motion dof:8: the DOF is a number from 0 to 7");
  EXPECT_THAT(message("dof:x"), HasSubstr("from 0 to 7"));
  EXPECT_THAT(message("dof:"), HasSubstr("from 0 to 7"));
  EXPECT_THAT(message("nowhere/none.bvh"), HasSubstr("none.bvh"));
  EXPECT_THROW((void)make_motion("sway", body, {.num_frames = -1}), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
