#include "silpose/segment/learned_segmenter.h"

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <filesystem>
#include <fstream>

#include "silpose/image/image_file.h"
#include "silpose/synth/colour_scene.h"

namespace silpose {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kNetworks = SILPOSE_DATA_DIR "/networks";  // of scripts/fetch-network-data

// A rendered person who sways; nobody in the first three frames.
const SyntheticSequence& sequence() {
  static const SyntheticSequence made = [] {
    auto body =
        std::make_shared<const BodyModel>(level_of_detail(load_body(SILPOSE_DATA_DIR "/human.body").value(), 3000));
    const SyntheticMotion motion = make_motion("sway", *body, {.num_frames = 4}).value();
    return make_sequence(body, motion, {.width = 480, .height = 360, .focal_px = 520, .lead_in = 3}).value();
  }();
  return made;
}

std::unique_ptr<Segmenter> segmenter(const CleanUpOptions& clean_up = {}) {
  return make_learned_segmenter(PersonNetwork::load(kNetworks).value(), PersonDetector::load(kNetworks).value(),
                                clean_up);
}

TEST(LearnedSegmenter, CutsOutARenderedPersonAndNobodyBefore) {
  const ColourScene scene(sequence(), 0);
  const auto learned = segmenter();
  EXPECT_EQ(learned->name(), "learned");
  for (int frame = 0; frame < sequence().num_frames(); ++frame) {
    const Segmentation found = learned->segment(scene.draw(frame), frame).value();
    EXPECT_EQ(found.nothing_found, frame < 3) << frame;
    if (frame < 3) continue;
    EXPECT_GT(intersection_over_union(found.mask, true_mask(sequence(), 0, frame)), 0.85) << frame;
  }
  EXPECT_THAT(learned->warnings(), IsEmpty());
}

TEST(LearnedSegmenter, FindsTheJointsWhereTheyAre) {
  const auto learned = segmenter();
  EXPECT_TRUE(learned->finds_landmarks());
  EXPECT_THAT(learned->segment(ColourScene(sequence(), 0).draw(0), 0).value().landmarks, IsEmpty());
  const Segmentation found = learned->segment(ColourScene(sequence(), 0).draw(4), 4).value();
  ASSERT_EQ(found.landmarks.size(), 14u);
  const auto names = landmark_names(*sequence().body);
  const auto positions = landmark_positions(*sequence().body, pose_of_frame(sequence(), 4));
  for (const SeenLandmark& seen : found.landmarks) {
    const auto at = std::ranges::find(names, seen.name) - names.begin();
    ASSERT_LT(at, std::ssize(names)) << seen.name;
    const Eigen::Vector2d truth = sequence().cameras[0].project(positions[static_cast<size_t>(at)]).value();
    EXPECT_LT(std::hypot(seen.x - truth.x(), seen.y - truth.y()), 0.08 * found.mask.bounding_box().height) << seen.name;
  }
}

// In space, too: thighs, shins and the trunk point where the rendered body's do.
TEST(LearnedSegmenter, SeesWhereLimbsPointInSpace) {
  const auto learned = segmenter();
  EXPECT_TRUE(learned->segment(ColourScene(sequence(), 0).draw(0), 0).value().keypoints.empty());
  const Keypoints3D found = learned->segment(ColourScene(sequence(), 0).draw(4), 4).value().keypoints;
  ASSERT_EQ(found.points.size(), 14u);
  const auto names = landmark_names(*sequence().body);
  const auto positions = landmark_positions(*sequence().body, pose_of_frame(sequence(), 4));
  const PinholeCamera& camera = sequence().cameras[0];
  const Eigen::Vector3d ray = camera.ray_from_pixel({found.centre_x, found.centre_y});
  const Eigen::Matrix3d world_from_keypoints =
      camera.cam_from_world.rotation.transpose() *
      Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), ray).toRotationMatrix();
  const auto truth = [&](const std::string& name) {
    return positions[static_cast<size_t>(std::ranges::find(names, name) - names.begin())];
  };
  const auto seen = [&](const std::string& name) -> Eigen::Vector3d {
    const Keypoint3D* point = found.find(name);
    return world_from_keypoints * Eigen::Vector3d(point->x[0], point->x[1], point->x[2]);
  };
  for (const auto& [from, to] : {std::pair{"left_thigh", "left_shin"},
                                 {"right_thigh", "right_shin"},
                                 {"left_shin", "left_foot"},
                                 {"right_shin", "right_foot"},
                                 {"left_thigh", "left_upper_arm"},
                                 {"right_thigh", "right_upper_arm"}}) {
    const Eigen::Vector3d expected = (truth(to) - truth(from)).normalized();
    EXPECT_GT(expected.dot((seen(to) - seen(from)).normalized()), std::cos(0.5)) << from;
  }
}

TEST(LearnedSegmenter, SaysWhenThePersonWasLost) {
  const ColourScene scene(sequence(), 0);
  const auto learned = segmenter();
  EXPECT_FALSE(learned->segment(scene.draw(4), 0).value().nothing_found);
  EXPECT_TRUE(learned->segment(scene.draw(0), 1).value().nothing_found);
  EXPECT_FALSE(learned->segment(scene.draw(4), 2).value().nothing_found);
  EXPECT_THAT(learned->warnings(), testing::ElementsAre(HasSubstr("lost 1 time")));
}

TEST(LearnedSegmenter, GoesOnFromItsState) {
  const ColourScene scene(sequence(), 0);
  const auto whole = segmenter(), second = segmenter();
  for (const int frame : {4, 0, 4, 5}) (void)whole->segment(scene.draw(frame), frame).value();
  second->restore(whole->state());
  const Segmentation expected = whole->segment(scene.draw(6), 6).value();
  const Segmentation found = second->segment(scene.draw(6), 6).value();
  EXPECT_EQ(found.mask, expected.mask);
  EXPECT_TRUE(std::ranges::equal(found.confidence.pixels(), expected.confidence.pixels()));
  EXPECT_EQ(second->warnings(), whole->warnings());
}

TEST(LearnedSegmenter, CountsOnlyWhoIsInTheRegion) {
  const ColourScene scene(sequence(), 0);
  CleanUpOptions clean_up;
  clean_up.region = Box{0, 0, 60, 360};
  EXPECT_TRUE(segmenter(clean_up)->segment(scene.draw(4), 0).value().nothing_found);
}

TEST(LearnedSegmenter, IsChosenWhereNothingElseIsAskedFor) {
  const fs::path folder = fs::temp_directory_path() / "silpose_learned_choice";
  fs::create_directories(folder / "clip");
  for (int i = 0; i < 3; ++i) {
    write_image((folder / fmt::format("clip/{}.png", i)).string(), ByteImage(64, 48, 3, 90)).value();
  }
  const std::string clip = (folder / "clip").string();
  EXPECT_EQ(make_segmenter(clip, {.networks = kNetworks}).value()->name(), "learned");
  EXPECT_EQ(make_segmenter(clip, {.networks = folder.string()}).value()->name(), "background auto");
  EXPECT_EQ(make_segmenter(clip, {.background = "auto", .networks = kNetworks}).value()->name(), "background auto");
  EXPECT_EQ(make_segmenter(clip, {.networks = kNetworks, .masks = clip}).value()->name(), "masks");
  EXPECT_THAT(make_segmenter(clip, {.kind = "learned", .networks = folder.string()}).error().message,
              HasSubstr("pose_landmark_full.tflite: no such file; scripts/fetch-network-data fetches it"));
  fs::copy_file(fs::path(kNetworks) / "pose_detection.tflite", folder / "pose_landmark_full.tflite",
                fs::copy_options::overwrite_existing);
  EXPECT_THAT(make_segmenter(clip, {.kind = "learned", .networks = folder.string()}).error().message,
              HasSubstr("no output 'Identity_2'"));
  fs::remove_all(folder);
}

// The real file cut short, as a broken download leaves it.
TEST(PersonNetwork, RefusesACutFile) {
  const fs::path folder = fs::temp_directory_path() / "silpose_learned_cut";
  fs::create_directories(folder);
  const fs::path file = folder / "pose_landmark_full.tflite";
  for (const size_t size : {size_t{100}, size_t{1'000'000}, size_t{6'440'000}}) {
    fs::copy_file(fs::path(kNetworks) / file.filename(), file, fs::copy_options::overwrite_existing);
    fs::resize_file(file, size);
    EXPECT_THAT(PersonNetwork::load(folder).error().message, HasSubstr("damaged or cut short")) << size;
  }
  fs::remove_all(folder);
}

}  // namespace
}  // namespace silpose
