#include "silpose/track/body_fit.h"

#include <gtest/gtest.h>

#include <cmath>

#include "silpose/base/parallel.h"
#include "silpose/base/rng.h"
#include "silpose/body/girth.h"
#include "silpose/body/stretchable.h"
#include "silpose/body/test_body.h"
#include "silpose/render/silhouette.h"

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
        observation.box = observation.mask.bounding_box();
        instant.observations.push_back(std::move(observation));
      }
      clip_.push_back(std::move(instant));
      Rng rng(1, static_cast<uint64_t>(t), 0);
      for (double& value : pose) value += 0.03 * rng.normal();
      poses_.push_back(std::move(pose));
    }
  }
  static std::vector<double> pose_at(int t) { return {0.02 * t, 0.52, 0, 0.2 * t, 0.1 * t, 0.05 * t, 0.3, -0.08 * t}; }

  const std::vector<double> longer_ = {0.01, -0.03};
  std::shared_ptr<const BodyModel> body_ = std::make_shared<BodyModel>(make_test_body());
  BodyModel subject_ = with_lengths(*body_, longer_);
  std::vector<PinholeCamera> cameras_ = {look_at_camera(320, 240, 300, {0, 1.2, 4.5}, {0, 0.75, 0}),
                                         look_at_camera(320, 240, 300, {4.5, 1.2, 0}, {0, 0.75, 0})};
  std::vector<ClipInstant> clip_;
  std::vector<std::vector<double>> poses_;
};

TEST_F(BodyFitTest, FindsTheLengthsThatTwoCamerasShow) {
  const BodyFit fit = fit_body(body_, cameras_, clip_, poses_).value();
  ASSERT_EQ(fit.lengths.size(), 2u);
  for (size_t s = 0; s < 2; ++s) {
    EXPECT_NEAR(fit.lengths[s], longer_[s], 0.01) << s;
    EXPECT_GT(fit.deviations[s], 0) << s;
    EXPECT_LT(fit.deviations[s], 0.01) << s;
  }
  EXPECT_NEAR(fit.body->height_m, subject_.height_m, 0.01);
}

TEST_F(BodyFitTest, IsSureOfLessWhereLessIsSeen) {
  const BodyFit fit = fit_body(body_, cameras_, clip_, poses_).value();
  const BodyFit of_one = fit_body(body_, cameras_, clip_, poses_, {.num_instants = 1}).value();
  for (size_t s = 0; s < 2; ++s) EXPECT_GT(of_one.deviations[s], fit.deviations[s]) << s;
}

TEST_F(BodyFitTest, LeavesOutWhatHasNoPose) {
  for (size_t t = 1; t < poses_.size(); ++t) poses_[t].clear();
  EXPECT_TRUE(fit_body(body_, cameras_, clip_, poses_).has_value());
  poses_[0].clear();
  EXPECT_FALSE(fit_body(body_, cameras_, clip_, poses_).has_value());
  poses_.pop_back();
  EXPECT_THROW((void)fit_body(body_, cameras_, clip_, poses_), std::invalid_argument);
}

TEST_F(BodyFitTest, NeedsTwoCamerasThatSeeTheSubject) {
  for (ClipInstant& instant : clip_) instant.observations[1].trust.nothing_found = true;
  EXPECT_FALSE(fit_body(body_, cameras_, clip_, poses_).has_value());
}

TEST_F(BodyFitTest, FindsHowThickTheSubjectIs) {
  const BodyModel thicker = Girths(subject_).applied(std::vector<double>(3, 0.08));
  for (int t = 0; t < 6; ++t) {
    for (size_t c = 0; c < 2; ++c) {
      Observation& observation = clip_[static_cast<size_t>(t)].observations[c];
      observation.mask = render_silhouette(thicker, cameras_[c], pose_at(t));
      observation.box = observation.mask.bounding_box();
    }
  }
  const BodyFit fit = fit_body(body_, cameras_, clip_, poses_).value();
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
  const BodyModel believed = scaled(*body_, 1.1);
  const auto shared = std::make_shared<const BodyModel>(believed);
  const BodyFit fit = fit_body(shared, {cameras_[0]}, clip_, poses_, {.floor = true}).value();
  EXPECT_NEAR(fit.size->factor, 1 / 1.1, 0.005);
  EXPECT_NEAR(fit.body->height_m, 1.5, 0.01);
  EXPECT_TRUE(fit.lengths.empty());
  EXPECT_FALSE(fit_body(shared, {cameras_[0]}, clip_, poses_).has_value()) << "without a floor";
}

TEST_F(BodyFitTest, LengthsStayWithinLimitsWhereCamerasAreMixedUp) {
  std::swap(cameras_[0], cameras_[1]);
  const BodyFit fit = fit_body(body_, cameras_, clip_, poses_).value();
  const Skeleton skeleton = stretchable(*body_).skeleton;
  for (size_t s = 0; s < fit.lengths.size(); ++s) {
    EXPECT_LE(std::abs(fit.lengths[s]), skeleton.dofs()[static_cast<size_t>(shape_dofs(skeleton)[s])].upper + 1e-12);
  }
}

TEST_F(BodyFitTest, TheNumberOfThreadsChangesNothing) {
  std::vector<double> lengths[2];
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    lengths[threads - 1] = fit_body(body_, cameras_, clip_, poses_).value().lengths;
  }
  EXPECT_EQ(lengths[0], lengths[1]);
}

}  // namespace
}  // namespace silpose
