#include "silpose/fit/landmark_proposal.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "silpose/likelihood/seen_human_for_test.h"

namespace silpose {
namespace {

using LandmarkProposalTest = SeenHumanTest;

TEST_F(LandmarkProposalTest, ProposesThePoseThatIsSeen) {
  const LandmarkProposal proposal(body_);
  for (const double heading : {0.3, 2.0, -1.2, 3.1}) {
    std::vector<double> truth = standing(heading);
    truth[static_cast<size_t>(dof("left_thigh_rx"))] = 0.9;
    truth[static_cast<size_t>(dof("left_shin_rx"))] = 0.7;
    truth[static_cast<size_t>(dof("right_upper_arm_rz"))] = 1.2;
    Rng rng(1, 0, 0);
    const Observation seen = see(truth, 2);
    const ProposalContext context{.observations = {&seen, 1}, .cameras = {&camera_, 1}};
    const StateBatch poses = proposal.propose(context, 0, rng).poses;
    ASSERT_GT(poses.rows(), 0);
    EXPECT_LT(poses.rows(), 40);
    const double facing = poses(0, dof("root_ry"));
    EXPECT_GT(std::cos(facing - heading), 0.85) << heading;
    EXPECT_NEAR(poses(0, dof("left_thigh_rx")), 0.9, 0.5) << heading;
    EXPECT_EQ(proposal.propose(context, 2, rng).poses.rows(), std::min<Eigen::Index>(2, poses.rows()));
  }
}

TEST_F(LandmarkProposalTest, WithoutLandmarksTheCommonPosesAreProposed) {
  Observation seen = see(standing(0));
  seen.keypoints_2d.clear();
  Rng rng(1, 0, 0);
  const ProposalContext context{.observations = {&seen, 1}, .cameras = {&camera_, 1}};
  const StateBatch poses = LandmarkProposal(body_).propose(context, 0, rng).poses;
  EXPECT_EQ(poses, CommonPoses(body_->skeleton, body_->profile).poses());
}

// The first camera does not see the subject: the second one's keypoints are used.
TEST_F(LandmarkProposalTest, UsesTheCameraThatHasKeypoints) {
  std::vector<double> truth = standing(0.3);
  const std::vector<Observation> seen = {Observation{Mask(camera_.width, camera_.height)}, see(truth, 2)};
  const std::vector<PinholeCamera> cameras = {look_at_camera(640, 480, 500, {5, 1, 0}, {0, 1, 0}), camera_};
  Rng rng(1, 0, 0), again(1, 0, 0);
  const LandmarkProposal proposal(body_);
  EXPECT_EQ(start_camera(seen), 1u);
  EXPECT_EQ(proposal.propose({.observations = seen, .cameras = cameras}, 0, rng).poses,
            proposal.propose({.observations = {&seen[1], 1}, .cameras = {&camera_, 1}}, 0, again).poses);
}

}  // namespace
}  // namespace silpose
