// What the default tracker does when it is lost: a limb, or the whole body, is where the subject's is not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>

#include "silpose/human/human_for_test.h"
#include "silpose/render/silhouette.h"
#include "silpose/track/tracker.h"

namespace silpose {
namespace {

class RecoveryTest : public ::testing::Test {
 protected:
  static std::shared_ptr<const BodyModel> human() { return human_for_test(1500); }

  double& dof(std::vector<double>& pose, const char* name) const {
    return pose[static_cast<size_t>(*body_->skeleton.find_dof(name))];
  }
  // Arms held out, one forwards, legs a little apart: nothing hides anything, no two limbs look alike.
  std::vector<double> truth(int t) const {
    std::vector<double> pose = standing_pose(*body_);
    dof(pose, "root_tx") += 0.01 * t;
    dof(pose, "right_upper_arm_rz") = 0.9;
    dof(pose, "left_upper_arm_rz") = 0.5;
    dof(pose, "left_upper_arm_rx") = -0.4;
    dof(pose, "right_thigh_rx") = -0.3 + 0.01 * t;
    body_->skeleton.clamp(pose);
    return pose;
  }
  double off(const std::vector<double>& pose, int t) const {
    return furthest_apart(landmark_positions(*body_, pose), landmark_positions(*body_, truth(t)));
  }
  // Metres that the joint which is furthest off is off: the median of the last ten of 20 frames that began at `start`.
  double off_in_the_end(const std::vector<double>& start) const {
    TrackerOptions options;
    options.body = body_;
    options.cameras = {camera_};
    options.lod_vertices = 0;
    options.initial_pose = start;
    Tracker tracker(options);
    std::vector<double> metres;
    for (int t = 0; t < 20; ++t) {
      Observation observation;
      observation.mask = render_silhouette(*body_, camera_, truth(t));
      const double now = off(tracker.step({&observation, 1}, t, t * int64_t{33'333'333}).pose, t);
      if (t >= 10) metres.push_back(now);
    }
    std::ranges::nth_element(metres, metres.begin() + 5);
    return metres[5];
  }

  std::shared_ptr<const BodyModel> body_ = human();
  PinholeCamera camera_ = look_at_camera(320, 240, 350, {1.5, 1.2, 4.5}, {0, 0.9, 0});
};

TEST_F(RecoveryTest, FindsALostArm) {
  std::vector<double> wrong = truth(0);
  dof(wrong, "right_upper_arm_rz") = 0;  // hangs, while the subject holds it out
  dof(wrong, "right_forearm_rx") = -1.5;
  body_->skeleton.clamp(wrong);
  ASSERT_GT(off(wrong, 0), 0.3);
  EXPECT_LT(off_in_the_end(wrong), 0.1);
}

TEST_F(RecoveryTest, SeeksTheWholeBodyAnew) {
  std::vector<double> wrong = standing_pose(*body_);
  dof(wrong, "root_tx") -= 2;
  dof(wrong, "root_tz") -= 3;
  EXPECT_LT(off_in_the_end(wrong), 0.1);
}

// Seen from behind; a silhouette does not show it.
TEST_F(RecoveryTest, FacesWhereLandmarksSaySoAndStaysSoWhereTheyAreWrongForAMoment) {
  TrackerOptions options;
  options.body = body_;
  options.cameras = {camera_};
  options.landmarks = true;
  options.evidence = EvidenceKind::kSilhouette;
  Tracker tracker(options);
  const auto names = landmark_names(*body_);
  for (int t = 0; t < 6; ++t) {
    std::vector<double> pose = truth(t);
    dof(pose, "root_ry") = 2.9;
    Observation observation;
    observation.mask = render_silhouette(*body_, camera_, pose);
    const auto positions = landmark_positions(*body_, pose);
    for (size_t i = 0; i < names.size(); ++i) {
      std::string name = names[i];
      if (t > 0 && name.starts_with("left_"))
        name = "right_" + name.substr(5);
      else if (t > 0 && name.starts_with("right_"))
        name = "left_" + name.substr(6);
      const Eigen::Vector2d pixel = camera_.project(positions[i]).value();
      observation.keypoints_2d.push_back({name, pixel.x(), pixel.y()});
    }
    std::vector<double> found = tracker.step({&observation, 1}, t, t * int64_t{33'333'333}).pose;
    EXPECT_GT(std::cos(dof(found, "root_ry") - 2.9), 0.7) << t;
  }
}

}  // namespace
}  // namespace silpose
