#include "silpose/fit/landmark_proposal.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "silpose/likelihood/seen_human_for_test.h"

namespace silpose {
namespace {

using LandmarkProposalTest = SeenHumanTest;

TEST_F(LandmarkProposalTest, ProposesThePoseThatIsSeen) {
  const LandmarkProposal proposal(body_, camera_);
  for (const double heading : {0.3, 2.0, -1.2, 3.1}) {
    std::vector<double> truth = standing(heading);
    truth[static_cast<size_t>(dof("left_thigh_rx"))] = 0.9;
    truth[static_cast<size_t>(dof("left_shin_rx"))] = 0.7;
    truth[static_cast<size_t>(dof("right_upper_arm_rz"))] = 1.2;
    Rng rng(1, 0, 0);
    const StateBatch poses = proposal.propose(see(truth, 2), 0, rng);
    ASSERT_GT(poses.rows(), 0);
    EXPECT_LT(poses.rows(), 40);
    const double facing = poses(0, dof("root_ry"));
    EXPECT_GT(std::cos(facing - heading), 0.85) << heading;
    EXPECT_NEAR(poses(0, dof("left_thigh_rx")), 0.9, 0.5) << heading;
    EXPECT_EQ(proposal.propose(see(truth, 2), 2, rng).rows(), std::min<Eigen::Index>(2, poses.rows()));
  }
}

TEST_F(LandmarkProposalTest, WithoutLandmarksTheCommonPosesAreProposed) {
  Observation seen = see(standing(0));
  seen.keypoints_2d.clear();
  Rng rng(1, 0, 0);
  const StateBatch poses = LandmarkProposal(body_, camera_).propose(seen, 0, rng);
  EXPECT_EQ(poses, CommonPoses(body_->skeleton, body_->profile).poses());
}

}  // namespace
}  // namespace silpose
