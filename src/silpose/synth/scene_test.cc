#include "silpose/synth/scene.h"

#include <gmock/gmock.h>

#include "silpose/body/test_body.h"
#include "silpose/synth/test_scene.h"

namespace silpose {
namespace {

using testing::HasSubstr;

SyntheticMotion resting(const BodyModel& body, double tx = 0) {
  SyntheticMotion motion;
  motion.poses.assign(3, std::vector<double>(static_cast<size_t>(body.skeleton.num_dofs()), 0.0));
  motion.poses.back()[0] = tx;
  return motion;
}

TEST(Scene, ViewsAreWordsOrDegrees) {
  EXPECT_EQ(parse_view("front")->azimuth_deg, 0);
  EXPECT_EQ(parse_view("side")->azimuth_deg, 90);
  EXPECT_EQ(parse_view("-35.5")->azimuth_deg, -35.5);
  EXPECT_EQ(parse_view("-35.5")->name, "-35.5");
  for (const char* bad : {"", "back", "30deg", "nan"}) {
    EXPECT_THAT(parse_view(bad).error().message, HasSubstr("front, side or degrees")) << bad;
  }
}

TEST(Scene, CamerasStandLevelAroundTheMiddleOfThePath) {
  auto body = std::make_shared<const BodyModel>(make_test_body());
  SceneOptions options;
  options.views = {{"front", 0}, {"side", 90}};
  const SyntheticSequence sequence = make_sequence(body, resting(*body, 1), options).value();
  ASSERT_EQ(sequence.cameras.size(), 2u);
  EXPECT_EQ(sequence.distance_m, 5.5);
  const Eigen::Vector3d front = sequence.cameras[0].centre_in_world(), side = sequence.cameras[1].centre_in_world();
  EXPECT_NEAR((front - side).norm(), 5.5 * std::sqrt(2), 1e-6);
  EXPECT_NEAR(front.y(), side.y(), 1e-9);
  EXPECT_NEAR(front.x(), 0.5, 1e-5);
  EXPECT_NEAR(front.z(), 5.5, 1e-5);
  EXPECT_GT(side.x(), 5);
  // The subject's left (+X) is at the right of an image of its front.
  const auto left = sequence.cameras[0].project({0.9, 0.7, 0}), right = sequence.cameras[0].project({0.1, 0.7, 0});
  EXPECT_GT(left->x(), right->x());
}

TEST(Scene, CamerasMoveBackUntilEveryFrameIsInside) {
  auto body = std::make_shared<const BodyModel>(make_test_body());
  const SyntheticSequence sequence = make_sequence(body, resting(*body, 9)).value();
  EXPECT_GT(sequence.distance_m, 9);
  for (int t = 0; t < 3; ++t) {
    const Mask mask = true_mask(sequence, 0, t);
    const Box box = mask.bounding_box();
    EXPECT_GT(box.x, 3);
    EXPECT_LT(box.x + box.width, 637);
    EXPECT_GT(mask.count(), 1000);
  }
  SceneOptions narrow;
  narrow.focal_px = 1e5;
  EXPECT_THAT(make_sequence(body, resting(*body, 9), narrow).error().message, HasSubstr("does not fit"));
}

TEST(Scene, LeadInIsEmptyAndCountsAsFrames) {
  const SyntheticSequence sequence = make_test_scene(5, 3);
  EXPECT_EQ(sequence.num_frames(), 8);
  EXPECT_EQ(true_mask(sequence, 0, 2).count(), 0);
  EXPECT_GT(true_mask(sequence, 0, 3).count(), 500);
  EXPECT_TRUE(pose_of_frame(sequence, 2).empty());
  EXPECT_EQ(pose_of_frame(sequence, 3).data(), sequence.poses[0].data());
  EXPECT_THROW((void)pose_of_frame(sequence, 8), std::invalid_argument);
}

TEST(Scene, RefusesWhatMakesNoScene) {
  auto body = std::make_shared<const BodyModel>(make_test_body());
  EXPECT_THAT(make_sequence(body, SyntheticMotion{}).error().message, HasSubstr("no frame"));
  SceneOptions twice;
  twice.views = {{"front", 0}, {"front", 10}};
  EXPECT_THROW((void)make_sequence(body, resting(*body), twice), std::invalid_argument);
  SceneOptions flat;
  flat.height = 0;
  EXPECT_THROW((void)make_sequence(body, resting(*body), flat), std::invalid_argument);
  EXPECT_THROW((void)make_sequence(nullptr, resting(*body)), std::invalid_argument);
}

TEST(TestScene, MasksAreOfTheStatedSize) {
  const SyntheticSequence sequence = make_test_scene();
  ASSERT_EQ(sequence.num_frames(), 20);
  const Box box = true_mask(sequence, 0, 0).bounding_box();
  EXPECT_NEAR(box.width, 23, 3);
  EXPECT_NEAR(box.height, 75, 4);
  EXPECT_NE(true_mask(sequence, 0, 0), true_mask(sequence, 0, 5));
}

}  // namespace
}  // namespace silpose
