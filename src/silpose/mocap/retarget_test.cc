#include "silpose/mocap/retarget.h"

#include <gmock/gmock.h>

#include <cmath>

#include "silpose/human/human.h"

namespace silpose {
namespace {

using Eigen::Vector3d;

// A stick figure: our skeleton on typed joint positions, soles 8 cm below the ankles, no mesh.
BodyModel stick_figure(double scale = 1, double leg_scale = 1) {
  std::vector<Vector3d> x = {{0, 0.95, 0},    {0, 1.05, 0},    {0, 1.2, 0},      {0, 1.5, 0},     {-0.05, 0.93, 0},
                             {-0.1, 0.9, 0},  {-0.1, 0.5, 0},  {-0.1, 0.08, 0},  {0.05, 0.93, 0}, {0.1, 0.9, 0},
                             {0.1, 0.5, 0},   {0.1, 0.08, 0},  {-0.05, 1.45, 0}, {-0.2, 1.42, 0}, {-0.2, 1.12, 0},
                             {-0.2, 0.86, 0}, {0.05, 1.45, 0}, {0.2, 1.42, 0},   {0.2, 1.12, 0},  {0.2, 0.86, 0}};
  for (const int knee : {6, 10}) x[knee].y() = 0.9 - 0.4 * leg_scale, x[knee + 1].y() = x[knee].y() - 0.42 * leg_scale;
  for (Vector3d& position : x) position *= scale;
  BodyModel body{"stick", human_skeleton(x), {}, {}, {}, {}, 0, 0, {}};
  body.skin.row_start = {0};
  body.joint_from_rest.resize(20);
  const double sole = 0.08 * scale;
  body.end_points = {{"head_top", 3, {0, 0.25 * scale, 0}},
                     {"right_toes", 7, {0, -sole, 0.15 * scale}},
                     {"left_toes", 11, {0, -sole, 0.15 * scale}}};
  return body;
}

// The motion of a stick figure as a capture file would hold it: joints named as ours, plus toes.
Clip clip_of(const BodyModel& body, const std::vector<std::vector<double>>& poses, double fps = 30) {
  Clip clip;
  clip.name = "test";
  clip.fps = fps;
  const auto joints = body.skeleton.joints();
  for (const Joint& joint : joints)
    clip.joints.push_back({joint.name, joint.parent_idx, joint.offset_in_parent, false});
  clip.joints.push_back({"right_toe", 7, {0, 0, 0.15}, false});
  clip.joints.push_back({"left_toe", 11, {0, 0, 0.15}, false});
  for (const auto& pose : poses) {
    const std::vector<Rigid3> world = body.skeleton.forward_kinematics(pose);
    for (size_t j = 0; j < joints.size(); ++j) {
      const int parent = joints[j].parent_idx;
      const Rigid3 local = parent < 0 ? world[j] : world[parent].inverse() * world[j];
      clip.rotations.emplace_back(local.rotation);
      clip.translations.push_back(local.translation);
    }
    for (int toe = 0; toe < 2; ++toe) {
      clip.rotations.push_back(Eigen::Quaterniond::Identity());
      clip.translations.emplace_back(0, 0, 0.15);
    }
  }
  return clip;
}

void set_deg(const Skeleton& skeleton, std::vector<double>& pose, const std::string& dof, double degrees) {
  pose[skeleton.find_dof(dof).value()] = to_radians(degrees);
}

// Walking along +X: legs and arms swing, elbows bent, root 0.9 m up.
std::vector<std::vector<double>> walking(const Skeleton& skeleton, int num_frames) {
  std::vector<std::vector<double>> poses;
  for (int t = 0; t < num_frames; ++t) {
    std::vector<double> pose(37, 0.0);
    const double swing = std::sin(0.3 * t);
    pose[0] = 0.03 * t, pose[1] = 0.9, pose[2] = 1.5;
    set_deg(skeleton, pose, "root_ry", 90);
    set_deg(skeleton, pose, "left_thigh_rx", 25 * swing);
    set_deg(skeleton, pose, "right_thigh_rx", -25 * swing);
    set_deg(skeleton, pose, "left_shin_rx", 30 - 20 * swing);
    set_deg(skeleton, pose, "right_shin_rx", 30 + 20 * swing);
    set_deg(skeleton, pose, "left_foot_rx", 10 * swing);
    set_deg(skeleton, pose, "left_upper_arm_rx", -20 * swing);
    set_deg(skeleton, pose, "right_upper_arm_rx", 20 * swing);
    set_deg(skeleton, pose, "left_upper_arm_rz", 12);
    set_deg(skeleton, pose, "right_upper_arm_rz", 12);
    set_deg(skeleton, pose, "left_forearm_rx", 35);
    set_deg(skeleton, pose, "right_forearm_rx", 35);
    set_deg(skeleton, pose, "head_ry", 30 * swing);
    set_deg(skeleton, pose, "thorax_ry", 8 * swing);
    poses.push_back(pose);
  }
  return poses;
}

TEST(Retarget, GivesTheSamePosesBackOnTheSameBody) {
  const BodyModel body = stick_figure();
  const auto poses = walking(body.skeleton, 30);
  const Retargeted result = retarget(clip_of(body, poses), body).value();
  ASSERT_EQ(result.poses.size(), 30u);
  EXPECT_FALSE(result.first_frame_skipped);
  EXPECT_FALSE(result.is_z_up);
  EXPECT_NEAR(result.metres_per_unit, 1, 1e-9);
  EXPECT_LT(result.mean_residual_deg, 0.3);
  EXPECT_LT(result.max_residual_deg, 1);
  for (size_t t = 0; t < poses.size(); ++t) {
    EXPECT_NEAR(result.poses[t][0], poses[t][0], 0.01);
    EXPECT_NEAR(result.poses[t][2], poses[t][2], 0.01);
    for (const char* dof :
         {"root_ry", "left_thigh_rx", "right_shin_rx", "left_foot_rx", "left_forearm_rx", "head_ry", "thorax_ry"}) {
      const int d = body.skeleton.find_dof(dof).value();
      EXPECT_NEAR(to_degrees(result.poses[t][d]), to_degrees(poses[t][d]), 4) << dof << " in frame " << t;
    }
  }
}

TEST(Retarget, MatchesDirectionsOnAnotherBodyAndScalesByTheLegs) {
  const BodyModel giant = stick_figure(17.5), ours = stick_figure(1, 0.9);
  auto poses = walking(giant.skeleton, 20);
  for (auto& pose : poses) pose[0] *= 17.5;
  const Retargeted result = retarget(clip_of(giant, poses), ours).value();
  EXPECT_NEAR(result.metres_per_unit, 0.9 / 17.5, 1e-9);
  EXPECT_LT(result.max_residual_deg, 1);
  EXPECT_NEAR(result.poses[19][0] - result.poses[0][0], 0.9 * 0.03 * 19, 0.02);
}

TEST(Retarget, StaysInsideTheLimitsWhereTheSourceDoesNot) {
  const BodyModel body = stick_figure();
  auto poses = walking(body.skeleton, 5);
  for (auto& pose : poses) set_deg(body.skeleton, pose, "left_shin_rx", -40);  // a knee bent the wrong way
  const Retargeted result = retarget(clip_of(body, poses), body).value();
  EXPECT_GT(result.max_residual_deg, 5);
  for (const auto& pose : result.poses) {
    std::vector<double> inside = pose;
    body.skeleton.clamp(inside);
    for (size_t d = 6; d < pose.size(); ++d) EXPECT_NEAR(pose[d], inside[d], 1e-12);
  }
}

TEST(Retarget, FreesALimbThatJumpsToAnotherPose) {
  const BodyModel body = stick_figure();
  const Skeleton& skeleton = body.skeleton;
  auto poses = walking(skeleton, 3);
  set_deg(skeleton, poses[0], "left_upper_arm_rz", 175);
  set_deg(skeleton, poses[0], "left_upper_arm_ry", 90);
  set_deg(skeleton, poses[0], "left_forearm_rx", 5);
  set_deg(skeleton, poses[1], "left_upper_arm_ry", -60);
  set_deg(skeleton, poses[1], "left_forearm_rx", 130);
  EXPECT_LT(retarget(clip_of(body, poses), body).value().max_residual_deg, 2);
}

TEST(Retarget, PutsTheFeetOnTheFloor) {
  const BodyModel body = stick_figure();
  auto poses = walking(body.skeleton, 20);
  for (auto& pose : poses) pose[1] += 7;
  const Retargeted result = retarget(clip_of(body, poses), body).value();
  int below = 0;
  double lowest = 1;
  for (const auto& pose : result.poses) {
    double y = 1;
    for (const Vector3d& x : landmark_positions(body, pose)) y = std::min(y, x.y());
    below += y < -1e-9;
    lowest = std::min(lowest, std::abs(y));
  }
  EXPECT_LE(below, 1);
  EXPECT_NEAR(lowest, 0, 1e-9);
}

TEST(Retarget, TakesEveryFourthFrameOf120HzAndInterpolatesOtherRates) {
  const BodyModel body = stick_figure();
  auto poses = walking(body.skeleton, 41);
  const Clip clip = clip_of(body, poses, 120.005);
  const Retargeted result = retarget(clip, body, {.fps = 30}).value();
  ASSERT_EQ(result.poses.size(), 11u);
  for (size_t t = 0; t < 11; ++t) EXPECT_NEAR(result.poses[t][0], 0.12 * static_cast<double>(t), 0.01);
  const Retargeted faster = retarget(clip_of(body, poses, 30), body, {.fps = 60}).value();
  ASSERT_EQ(faster.poses.size(), 81u);
  EXPECT_NEAR(faster.poses[41][0], 0.03 * 20.5, 0.01);
}

TEST(Retarget, SkipsACalibrationPoseAtTheStart) {
  const BodyModel body = stick_figure();
  auto poses = walking(body.skeleton, 10);
  EXPECT_FALSE(retarget(clip_of(body, poses), body).value().first_frame_skipped);
  poses[0] = std::vector<double>(37, 0.0);
  const Retargeted result = retarget(clip_of(body, poses), body).value();
  EXPECT_TRUE(result.first_frame_skipped);
  ASSERT_EQ(result.poses.size(), 9u);
  EXPECT_NEAR(result.poses[0][0], 0.03, 0.01);
}

TEST(Retarget, TurnsAClipWhoseWorldHasZUp) {
  const BodyModel body = stick_figure();
  const auto poses = walking(body.skeleton, 10);
  Clip clip = clip_of(body, poses);
  Eigen::Matrix3d z_up_from_y_up;
  z_up_from_y_up << 1, 0, 0, 0, 0, -1, 0, 1, 0;
  for (Clip::Joint& joint : clip.joints) joint.offset = z_up_from_y_up * joint.offset;
  for (Vector3d& x : clip.translations) x = z_up_from_y_up * x;
  for (Eigen::Quaterniond& q : clip.rotations) {
    q = Eigen::Quaterniond(Eigen::Matrix3d(z_up_from_y_up * q.toRotationMatrix() * z_up_from_y_up.transpose()));
  }
  const Retargeted result = retarget(clip, body).value(), plain = retarget(clip_of(body, poses), body).value();
  EXPECT_TRUE(result.is_z_up);
  for (size_t d = 0; d < 37; ++d) EXPECT_NEAR(result.poses[9][d], plain.poses[9][d], 1e-6);
}

TEST(Retarget, NamesWhatAClipLacks) {
  const BodyModel body = stick_figure();
  Clip clip = clip_of(body, walking(body.skeleton, 3));
  clip.joints[18].name = "left_flipper";
  const auto result = retarget(clip, body);
  ASSERT_FALSE(result.ok());
  EXPECT_EQ(result.error().message, "test: no joint that could be left_forearm");
  EXPECT_EQ(retarget(Clip(), body).error().message, ": no frame");
  Clip point = clip_of(body, walking(body.skeleton, 3));
  for (Clip::Joint& joint : point.joints) joint.offset.setZero();
  EXPECT_THAT(retarget(point, body).error().message, testing::HasSubstr("rest pose"));
  EXPECT_THROW((void)retarget(clip, body, {.fps = 0}), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
