#include "silpose/fit/landmark_proposal.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "silpose/base/rng.h"
#include "silpose/human/human_for_test.h"

namespace silpose {
namespace {

class LandmarkProposalTest : public testing::Test {
 protected:
  static std::shared_ptr<const BodyModel> human() { return human_for_test(); }

  int dof(const char* name) const { return body_->skeleton.find_dof(name).value(); }

  std::vector<double> standing(double heading) const {
    std::vector<double> pose(static_cast<size_t>(body_->skeleton.num_dofs()), 0.0);
    pose[static_cast<size_t>(dof("root_ty"))] = 0.95;
    pose[static_cast<size_t>(dof("root_ry"))] = heading;
    return pose;
  }

  // All joints and end points, off by a deviation of `noise_px`; a mask as large as the body.
  Observation see(const std::vector<double>& pose, double noise_px = 0) const {
    Observation seen{Mask(camera_.width, camera_.height)};
    const auto names = landmark_names(*body_);
    const auto positions = landmark_positions(*body_, pose);
    Rng rng(3, 0, 0);
    Eigen::Vector2d least(1e9, 1e9), most(-1e9, -1e9);
    for (size_t i = 0; i < names.size(); ++i) {
      const Eigen::Vector2d pixel =
          camera_.project(positions[i]).value() + noise_px * Eigen::Vector2d(rng.normal(), rng.normal());
      seen.keypoints_2d.push_back({names[i], pixel.x(), pixel.y()});
      least = least.cwiseMin(pixel), most = most.cwiseMax(pixel);
    }
    const Box box = {static_cast<int>(least.x()), static_cast<int>(least.y()), static_cast<int>(most.x() - least.x()),
                     static_cast<int>(most.y() - least.y())};
    const int width = box.height / 10;  // of a body that covers a tenth of its height squared
    const int middle = box.x + box.width / 2;
    for (int y = box.y; y < box.y + box.height; ++y) {
      for (int x = middle - width / 2; x < middle - width / 2 + width; ++x) seen.mask.set(x, y);
    }
    seen.mask.set(box.x, box.y), seen.mask.set(box.x + box.width - 1, box.y);  // hands
    return seen;
  }

  std::shared_ptr<const BodyModel> body_ = human();
  PinholeCamera camera_ = default_camera(640, 480);
};

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
