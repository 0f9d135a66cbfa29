#include "silpose/offline/body_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "silpose/base/parallel.h"
#include "silpose/base/rng.h"
#include "silpose/body/girth.h"
#include "silpose/body/stretchable.h"
#include "silpose/body/test_body.h"
#include "silpose/human/human_for_test.h"
#include "silpose/render/silhouette.h"
#include "silpose/synth/simulated_keypoints.h"

namespace silpose {
namespace {

// The tube with both of its bones of another length, seen by two cameras, its poses known roughly.
class BodyFitTest : public ::testing::Test {
 protected:
  BodyFitTest() {
    for (int t = 0; t < 6; ++t) {
      ClipInstant instant{.frame_idx = t, .time_ns = t * int64_t{33'333'333}, .observations = {}};
      std::vector<double> pose = pose_at(t);
      for (const PinholeCamera& camera : cameras_) {
        Observation observation;
        observation.mask = render_silhouette(subject_, camera, pose);
        instant.observations.push_back(std::move(observation));
      }
      clip_.push_back(std::move(instant));
      Rng rng(1, static_cast<uint64_t>(t), 0);
      for (double& value : pose) value += 0.03 * rng.normal();
      poses_.push_back(std::move(pose));
    }
  }
  static std::vector<double> pose_at(int t) { return {0.02 * t, 0.52, 0, 0.2 * t, 0.1 * t, 0.05 * t, 0.3, -0.08 * t}; }

  [[nodiscard]] TrackerOptions options() const {
    TrackerOptions options;
    options.body = body_;
    options.cameras = cameras_;
    options.fitted()->floor = false;
    return options;
  }

  const std::vector<double> longer_ = {0.01, -0.03};
  std::shared_ptr<const BodyModel> body_ = std::make_shared<BodyModel>(make_test_body());
  BodyModel subject_ = with_lengths(*body_, longer_);
  std::vector<PinholeCamera> cameras_ = {look_at_camera(320, 240, 300, {0, 1.2, 4.5}, {0, 0.75, 0}),
                                         look_at_camera(320, 240, 300, {4.5, 1.2, 0}, {0, 0.75, 0})};
  std::vector<ClipInstant> clip_;
  std::vector<std::vector<double>> poses_;
};

TEST_F(BodyFitTest, FindsTheLengthsThatTwoCamerasShow) {
  const BodyFit fit = fit_body(options(), clip_, poses_).value();
  ASSERT_EQ(fit.lengths.size(), 2u);
  for (size_t s = 0; s < 2; ++s) {
    EXPECT_NEAR(fit.lengths[s], longer_[s], 0.01) << s;
    EXPECT_GT(fit.deviations[s], 0) << s;
    EXPECT_LT(fit.deviations[s], 0.01) << s;
  }
  EXPECT_NEAR(fit.body->height_m, subject_.height_m, 0.01);
}

TEST_F(BodyFitTest, IsSureOfLessWhereLessIsSeen) {
  const BodyFit fit = fit_body(options(), clip_, poses_).value();
  const BodyFit of_one = fit_body(options(), std::span(clip_).first(1), std::span(poses_).first(1)).value();
  for (size_t s = 0; s < 2; ++s) EXPECT_GT(of_one.deviations[s], fit.deviations[s]) << s;
}

TEST_F(BodyFitTest, LeavesOutWhatHasNoPose) {
  for (size_t t = 1; t < poses_.size(); ++t) poses_[t].clear();
  EXPECT_TRUE(fit_body(options(), clip_, poses_).has_value());
  poses_[0].clear();
  EXPECT_FALSE(fit_body(options(), clip_, poses_).has_value());
  poses_.pop_back();
  EXPECT_THROW((void)fit_body(options(), clip_, poses_), std::invalid_argument);
}

TEST_F(BodyFitTest, NeedsTwoCamerasThatSeeTheSubject) {
  for (ClipInstant& instant : clip_) instant.observations[1].trust.nothing_found = true;
  EXPECT_FALSE(fit_body(options(), clip_, poses_).has_value());
}

TEST_F(BodyFitTest, FindsHowThickTheSubjectIs) {
  const BodyModel thicker = Girths(subject_).applied(std::vector<double>(3, 0.08));
  for (int t = 0; t < 6; ++t) {
    for (size_t c = 0; c < 2; ++c) {
      Observation& observation = clip_[static_cast<size_t>(t)].observations[c];
      observation.mask = render_silhouette(thicker, cameras_[c], pose_at(t));
    }
  }
  const BodyFit fit = fit_body(options(), clip_, poses_).value();
  ASSERT_EQ(fit.girths.size(), 3u);
  for (const BodyFit::Girth& girth : fit.girths) {
    EXPECT_NEAR(girth.share, 0.08, 0.035) << girth.name;
    EXPECT_GT(girth.deviation, 0) << girth.name;
  }
}

// Standing still on the floor, seen by a tracker that believes it a tenth too large: a tenth too far away.
TEST_F(BodyFitTest, OneCameraTellsTheSizeByTheFloor) {
  const Eigen::Vector3d centre = cameras_[0].centre_in_world();
  for (std::vector<double>& pose : poses_) {
    pose = {0, 0.5, 0, 0, 0, 0, 0, 0};  // the root is in the middle of the tube's lowest metre
    for (int k = 0; k < 3; ++k) {
      double& at = pose[static_cast<size_t>(k)];
      at = centre[k] + 1.1 * (at - centre[k]);
    }
  }
  for (ClipInstant& instant : clip_) instant.observations.resize(1);
  TrackerOptions larger = options();
  larger.body = std::make_shared<const BodyModel>(scaled(*body_, 1.1));
  larger.cameras = {cameras_[0]};
  EXPECT_FALSE(fit_body(larger, clip_, poses_).has_value()) << "without a floor";
  larger.fitted()->floor = true;
  const BodyFit fit = fit_body(larger, clip_, poses_).value();
  EXPECT_NEAR(fit.size->factor, 1 / 1.1, 0.005);
  EXPECT_NEAR(fit.body->height_m, 1.5, 0.01);
  EXPECT_TRUE(fit.lengths.empty());
}

TEST_F(BodyFitTest, LengthsStayWithinLimitsWhereCamerasAreMixedUp) {
  std::swap(cameras_[0], cameras_[1]);
  const BodyFit fit = fit_body(options(), clip_, poses_).value();
  const Skeleton skeleton = stretchable(*body_).skeleton;
  for (size_t s = 0; s < fit.lengths.size(); ++s) {
    EXPECT_LE(std::abs(fit.lengths[s]), skeleton.dofs()[static_cast<size_t>(shape_dofs(skeleton)[s])].upper + 1e-12);
  }
}

TEST_F(BodyFitTest, TheNumberOfThreadsChangesNothing) {
  std::vector<double> lengths[2];
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    lengths[threads - 1] = fit_body(options(), clip_, poses_).value().lengths;
  }
  EXPECT_EQ(lengths[0], lengths[1]);
}

// A person with shorter legs and a longer trunk than people of their stature, seen by one camera and a network.
class OneCameraFitTest : public ::testing::Test {
 protected:
  static std::shared_ptr<const BodyModel> human() { return human_for_test(2000); }
  OneCameraFitTest() {
    const Skeleton stretched = stretchable(*body_).skeleton;
    for (const int d : shape_dofs(stretched)) {
      const std::string_view name = without_side(stretched.dofs()[static_cast<size_t>(d)].name);
      longer_.push_back(name == "shin_length" || name == "foot_length" ? -0.025 : name == "thorax_length" ? 0.05 : 0);
    }
    const auto subject = std::make_shared<const BodyModel>(with_lengths(*body_, longer_));
    SyntheticMotion motion;
    for (int t = 0; t < 8; ++t) {
      motion.poses.push_back(standing_pose(*subject));
      std::vector<double>& pose = motion.poses.back();
      pose[dof("root_ry")] = 0.15 * t;
      pose[dof("right_thigh_rx")] = -0.1 * t;
      pose[dof("right_shin_rx")] = 0.05 * t;  // the left leg stands
      pose[dof("right_upper_arm_rz")] = 0.9, pose[dof("left_upper_arm_rz")] = 0.6;
      subject->skeleton.clamp(pose);
    }
    sequence_ = make_sequence(subject, motion, {.views = {{"it", 20}}}).value();
    const SimulatedKeypoints network(sequence_, 0, 1);
    for (int t = 0; t < sequence_.num_frames(); ++t) {
      Observation seen;
      seen.mask = true_mask(sequence_, 0, t);
      SimulatedKeypoints::Seen drawn = network.draw(t, seen.box());
      seen.keypoints_2d = std::move(drawn.keypoints_2d);
      seen.keypoints_3d = std::move(drawn.keypoints_3d);
      clip_.push_back({t, t * int64_t{33'333'333}, {std::move(seen)}});
    }
  }
  size_t dof(const char* name) const { return static_cast<size_t>(body_->skeleton.find_dof(name).value()); }
  [[nodiscard]] TrackerOptions options(EvidenceKind evidence = EvidenceKind::kBoth) const {
    TrackerOptions options;
    options.body = body_;
    options.cameras = sequence_.cameras;
    options.fitted()->floor = false;
    options.evidence = evidence;
    return options;
  }
  [[nodiscard]] std::optional<BodyFit> fit(const TrackerOptions& options) const {
    return fit_body(options, clip_, sequence_.poses);
  }
  // Metres that the two bones of a leg are longer, the mean of both legs, and the trunk with the neck is.
  static std::pair<double, double> leg_and_trunk(const BodyFit& fit) {
    double leg = 0, trunk = 0;
    for (size_t s = 0; s < fit.names.size(); ++s) {
      const std::string_view name = without_side(fit.names[s]);
      if (name == "shin_length" || name == "foot_length") leg += fit.lengths[s] / 2;
      if (name == "thorax_length" || name == "head_length") trunk += fit.lengths[s];
    }
    return {leg, trunk};
  }

  std::shared_ptr<const BodyModel> body_ = human();
  std::vector<double> longer_;
  SyntheticSequence sequence_;
  std::vector<ClipInstant> clip_;
};

TEST_F(OneCameraFitTest, KeypointsTellBonesAndTheStatureStays) {
  const std::optional<BodyFit> fitted = fit(options());
  ASSERT_TRUE(fitted.has_value());
  const auto [leg, trunk] = leg_and_trunk(*fitted);
  EXPECT_NEAR(leg, -0.05, 0.03);  // the prior pulls to the body's own: half is found
  EXPECT_NEAR(trunk, 0.05, 0.03);
  EXPECT_NEAR(fitted->body->height_m, body_->height_m, 0.02);
  EXPECT_FALSE(fitted->size.has_value());
}

TEST_F(OneCameraFitTest, TellsNothingWithoutKeypointsThatCount) {
  EXPECT_FALSE(fit(options(EvidenceKind::kSilhouette)).has_value());
  for (ClipInstant& instant : clip_) instant.observations[0].keypoints_3d = {};
  EXPECT_FALSE(fit(options()).has_value());
}

TEST_F(OneCameraFitTest, LeavesOutKeypointsWhoseSidesAreExchanged) {
  const Observation seen = clip_[3].observations[0];
  clip_[3].observations[0].keypoints_3d = {};
  clip_[3].observations[0].keypoints_2d.clear();
  const auto [leg, trunk] = leg_and_trunk(fit(options()).value());
  clip_[3].observations[0] = seen;
  for (Keypoint3D& point : clip_[3].observations[0].keypoints_3d.points) {
    point.x[2] = -point.x[2];
    point.name = point.name.starts_with("left_") ? "right_" + point.name.substr(5) : "left_" + point.name.substr(6);
  }
  const auto [leg_then, trunk_then] = leg_and_trunk(fit(options()).value());
  EXPECT_NEAR(leg_then, leg, 1e-9);
  EXPECT_NEAR(trunk_then, trunk, 1e-9);
}

TEST_F(OneCameraFitTest, ASizeThatIsNotKnownComesFromTheFloor) {
  TrackerOptions larger = options();
  larger.body = std::make_shared<const BodyModel>(scaled(*body_, 1.08));
  larger.fitted()->floor = true;
  larger.size_deviation = 0.05;
  const Eigen::Vector3d centre = sequence_.cameras[0].centre_in_world();
  for (std::vector<double>& pose : sequence_.poses) {
    Eigen::Vector3d root = body_->skeleton.forward_kinematics(pose).front().translation;
    root.y() += 0.05;  // the body's legs are so much longer than the subject's
    place_root(body_->skeleton, body_->profile, pose, centre + 1.08 * (root - centre));
  }
  const auto fitted = fit(larger);
  ASSERT_TRUE(fitted.has_value() && fitted->size.has_value());
  EXPECT_NEAR(fitted->size->factor, 1 / 1.08, 0.02);
  EXPECT_NEAR(fitted->body->height_m, body_->height_m, 0.04);
  EXPECT_LT(leg_and_trunk(*fitted).first, -0.02);
  EXPECT_GT(fitted->size_deviation, 0);
}

TEST_F(OneCameraFitTest, OptionsTakeTheFittedBody) {
  const std::optional<BodyFit> fitted = fit(options());
  const TrackerOptions after = options_after_fit(options(), fitted.value());
  EXPECT_EQ(after.body, fitted->body);
  EXPECT_EQ(after.size_deviation, fitted->size_deviation);
  EXPECT_FALSE(options_before_fit(options()).has_floor()) << "one camera";
}

}  // namespace
}  // namespace silpose
