#include "silpose/synth/simulated_keypoints.h"

#include <gtest/gtest.h>

#include "silpose/body/test_body.h"
#include "silpose/human/human_for_test.h"
#include "silpose/shape/keypoint_axes.h"
#include "silpose/synth/test_scene.h"

namespace silpose {
namespace {

SyntheticSequence human_that_stands(int num_frames, int lead_in = 0) {
  const auto body = human_for_test(1500);
  SyntheticMotion motion;
  motion.poses.assign(static_cast<size_t>(num_frames), standing_pose(*body));
  return make_sequence(body, motion, {.views = {{"it", 30}}, .lead_in = lead_in}).value();
}

// The unit vector from one keypoint to another, in the world.
Eigen::Vector3d direction(const SyntheticSequence& sequence, const Keypoints3D& keypoints, const char* from,
                          const char* to) {
  const auto *const a = keypoints.find(from), *const b = keypoints.find(to);
  return world_from_keypoints(sequence.cameras[0], keypoints) *
         Eigen::Vector3d(b->x[0] - a->x[0], b->x[1] - a->x[1], b->x[2] - a->x[2]).normalized();
}

TEST(SimulatedKeypoints, DirectionsAreOffAsFarAsSaid) {
  const SyntheticSequence sequence = human_that_stands(40);
  const Box box = true_mask(sequence, 0, 0).bounding_box();
  const Eigen::Vector3d true_thigh(0, -1, 0);  // in the zero pose
  const Eigen::Vector3d ray = sequence.cameras[0].cam_from_world.rotation.row(2).transpose();
  double in_depth = 0, of_mean = 0;
  constexpr int kSeeds = 40, kFrames = 40;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const SimulatedKeypoints network(sequence, 0, static_cast<uint64_t>(seed));
    double mean = 0;
    for (int frame = 0; frame < kFrames; ++frame) {
      const Keypoints3D seen = network.draw(frame, box).keypoints_3d;
      const double off = (direction(sequence, seen, "left_thigh", "left_shin") - true_thigh).dot(ray);
      in_depth += off * off / (kSeeds * kFrames);
      mean += off / kFrames;
    }
    of_mean += mean * mean / kSeeds;
  }
  EXPECT_NEAR(std::sqrt(in_depth), 0.18, 0.04);
  EXPECT_NEAR(of_mean / in_depth, 0.5, 0.2) << "half of it is the same in all frames";
}

TEST(SimulatedKeypoints, PlacesAreNearTheJoints) {
  const SyntheticSequence sequence = human_that_stands(3);
  const SimulatedKeypoints network(sequence, 0, 1);
  const auto names = landmark_names(*sequence.body);
  const auto positions = landmark_positions(*sequence.body, sequence.poses[0]);
  const SimulatedKeypoints::Seen seen = network.draw(0, true_mask(sequence, 0, 0).bounding_box());
  EXPECT_EQ(seen.keypoints_2d.size(), 12U);
  EXPECT_EQ(seen.keypoints_3d.points.size(), 12U);
  for (const Keypoint2D& landmark : seen.keypoints_2d) {
    const auto i = static_cast<size_t>(std::ranges::find(names, landmark.name) - names.begin());
    const Eigen::Vector2d pixel = sequence.cameras[0].project(positions[i]).value();
    EXPECT_LT((pixel - Eigen::Vector2d(landmark.x, landmark.y)).norm(), 20) << landmark.name;
    EXPECT_GT((pixel - Eigen::Vector2d(landmark.x, landmark.y)).norm(), 0) << landmark.name;
  }
}

TEST(SimulatedKeypoints, AFrameIsTheSameInAnyOrderAndOthersDiffer) {
  const SyntheticSequence sequence = human_that_stands(3, 1);
  const SimulatedKeypoints network(sequence, 0, 7), again(sequence, 0, 7), other(sequence, 0, 8);
  const Box box{100, 100, 50, 200};
  EXPECT_TRUE(network.draw(0, box).keypoints_3d.empty()) << "nobody is there yet";
  const auto x = [&](const SimulatedKeypoints& of, int frame) { return of.draw(frame, box).keypoints_3d.points[3].x; };
  const auto third = x(network, 3);
  EXPECT_EQ(x(again, 3), third);
  EXPECT_NE(x(network, 2), third);
  EXPECT_NE(x(other, 3), third);
}

TEST(SimulatedKeypoints, RefusesABodyThatHasNoneOfTheJoints) {
  const SyntheticSequence sequence = make_test_scene(2);
  EXPECT_THROW(SimulatedKeypoints(sequence, 0, 1), std::invalid_argument);
  EXPECT_THROW(SimulatedKeypoints(human_that_stands(1), 1, 1), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
