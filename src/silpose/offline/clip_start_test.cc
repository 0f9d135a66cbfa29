#include "silpose/offline/clip_start.h"

#include <gtest/gtest.h>

#include "silpose/render/silhouette.h"
#include "silpose/track/keypoints_for_test.h"
#include "silpose/track/tracker_presets.h"

namespace silpose {
namespace {

// A standing body at four instants, 1 s apart.
class ClipStartTest : public testing::Test {
 protected:
  ClipStartTest() {
    for (int t = 0; t < 4; ++t) {
      clip_.push_back({.frame_idx = t, .time_ns = t * int64_t{1'000'000'000}, .observations = {{}}});
      clip_.back().observations[0].mask = render_silhouette(*body_, camera_, pose_);
    }
  }
  TrackerOptions options() const {
    TrackerOptions options = accurate_preset();
    options.body = body_;
    options.cameras = {camera_};
    return options;
  }
  size_t start(const TrackerOptions& options, const std::vector<bool>& seen) const {
    return choose_start(options, JudgedClip(clip_, 1), seen, [] { return true; });
  }

  std::shared_ptr<const BodyModel> body_ = std::make_shared<BodyModel>(make_sided_body());
  PinholeCamera camera_ = look_at_camera(160, 120, 150, {0, 1.2, 4.5}, {0, 0.75, 0});
  std::vector<double> pose_ = {0, 0.5, 0, 0, 0, 0, 0, 0};
  std::vector<ClipInstant> clip_;
};

TEST_F(ClipStartTest, AnInitialPoseIsOfTheFirstInstantThatIsSeen) {
  TrackerOptions given = options();
  given.initial_pose = pose_;
  EXPECT_EQ(start(given, {false, false, true, true}), 2U);
  EXPECT_THROW(start(given, std::vector<bool>(4, false)), std::invalid_argument);
}

TEST_F(ClipStartTest, StartsWhereThereAreKeypoints) {
  add_keypoints(*body_, camera_, pose_, clip_[1].observations[0]);
  TrackerOptions by_keypoints = options();
  by_keypoints.evidence = EvidenceKind::kBoth;
  by_keypoints.landmarks = true;
  EXPECT_EQ(start(by_keypoints, std::vector<bool>(4, true)), 1U);
}

// A wide bar across the body makes a long outline, so that such masks are tried first; but no pose has it.
TEST_F(ClipStartTest, StartsWhereAPoseExplainsTheSilhouetteBest) {
  for (const size_t t : {size_t{0}, size_t{2}}) {
    Mask& mask = clip_[t].observations[0].mask;
    for (int y = 40; y < 80; ++y) {
      for (int x = 0; x < mask.width(); ++x) mask.set(x, y, x > 20 && x < 140);
    }
  }
  EXPECT_EQ(start(options(), std::vector<bool>(4, true)), 1U);
}

TEST_F(ClipStartTest, MayBeStopped) {
  int asked = 0;
  const size_t chosen = choose_start(options(), JudgedClip(clip_, 1), std::vector<bool>(4, true), [&] {
    ++asked;
    return false;
  });
  EXPECT_LT(chosen, 4U);
  EXPECT_EQ(asked, 1);
}

}  // namespace
}  // namespace silpose
