// Recorded clips from their files to their scores, on clips rendered here.
#include "silpose/experiment/recorded_clip.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <optional>

#include "silpose/body/test_body.h"
#include "silpose/experiment/clip_reader.h"
#include "silpose/experiment/tracking_runs.h"
#include "silpose/synth/sequence_files.h"
#include "silpose/synth/test_scene.h"

namespace silpose {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
namespace fs = std::filesystem;

constexpr int kFrames = 6;
const auto kAlways = [] { return true; };

// A folder with one clip, "walk", of two cameras: walk/masks_front, walk/masks_side, walk/camera.toml, walk/joints.csv.
class RecordedClip : public testing::Test {
 protected:
  void SetUp() override {
    data_ = fs::path(testing::TempDir()) /
            (std::string("recorded_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(data_);
    SyntheticMotionOptions motion;
    motion.num_frames = kFrames;
    motion.amplitude_deg = 20;
    motion.period_s = 20 / motion.fps;
    const auto body = std::make_shared<const BodyModel>(make_test_body());
    SceneOptions scene{.width = 160, .height = 120, .focal_px = 200, .distance_m = 4};
    scene.views = {{"front", 0}, {"side", 90}};
    sequence_ = make_sequence(body, make_motion("sway", *body, motion).value(), scene).value();
    ASSERT_EQ(write_sequence(data_ / "walk", sequence_).value(), kFrames);
  }
  void TearDown() override { fs::remove_all(data_); }

  [[nodiscard]] ClipInput input(const std::vector<std::string>& cameras, int num_frames = 0) const {
    ClipInput wanted{.videos = {}, .segmenter = "masks", .backgrounds = {}, .num_frames = num_frames};
    for (const std::string& camera : cameras) wanted.videos.push_back((data_ / "walk" / ("masks_" + camera)).string());
    return wanted;
  }
  void write(const std::string& file, const std::string& bytes) const {
    fs::create_directories((data_ / file).parent_path());
    std::ofstream(data_ / file, std::ios::binary) << bytes;
  }

  fs::path data_;
  SyntheticSequence sequence_;
};

TEST_F(RecordedClip, EachVideoIsSegmentedOnce) {
  ClipReader reader("");
  const auto side = reader.read(input({"side"}), kAlways).value().value();
  ASSERT_EQ(side.size(), static_cast<size_t>(kFrames));
  EXPECT_EQ(reader.num_segmented(), kFrames);
  const auto both = reader.read(input({"front", "side"}), kAlways).value().value();
  EXPECT_EQ(reader.num_segmented(), 2 * kFrames);
  ASSERT_EQ(both.size(), static_cast<size_t>(kFrames));
  for (int t = 0; t < kFrames; ++t) {
    const auto& observations = both[static_cast<size_t>(t)].observations;
    ASSERT_EQ(observations.size(), 2U);
    for (int c = 0; c < 2; ++c) {
      EXPECT_EQ(intersection_over_union(observations[static_cast<size_t>(c)].mask, true_mask(sequence_, c, t)), 1);
    }
    EXPECT_EQ(both[static_cast<size_t>(t)].frame_idx, t);
    EXPECT_EQ(both[static_cast<size_t>(t)].time_ns, side[static_cast<size_t>(t)].time_ns);
  }
  EXPECT_EQ(reader.read(input({"front"}, 3), kAlways).value().value().size(), 3U);
  EXPECT_EQ(reader.num_segmented(), 2 * kFrames);
}

TEST_F(RecordedClip, APartIsKeptAndMadeLonger) {
  ClipReader reader("");
  EXPECT_EQ(reader.read(input({"front"}, 2), kAlways).value().value().size(), 2U);
  EXPECT_EQ(reader.num_segmented(), 2);
  EXPECT_EQ(reader.read(input({"front", "side"}, 2), kAlways).value().value().size(), 2U);
  EXPECT_EQ(reader.num_segmented(), 4);
  EXPECT_EQ(reader.read(input({"front"}), kAlways).value().value().size(), static_cast<size_t>(kFrames));
  EXPECT_EQ(reader.num_segmented(), 4 + kFrames);
}

TEST_F(RecordedClip, WhatIsTooMuchIsDropped) {
  ClipReader reader("", 0);
  EXPECT_EQ(reader.read(input({"front"}), kAlways).value().value().size(), static_cast<size_t>(kFrames));
  EXPECT_EQ(reader.kept_bytes(), 0U);
  ClipReader roomy("");
  (void)roomy.read(input({"front"}), kAlways);
  EXPECT_EQ(roomy.kept_bytes(), static_cast<size_t>(kFrames * 160 * 120 / 8));
}

TEST_F(RecordedClip, StopsWhenAsked) {
  ClipReader reader("");
  int calls = 3;
  EXPECT_FALSE(reader.read(input({"front"}), [&] { return calls-- > 0; }).value().has_value());
  EXPECT_EQ(reader.kept_bytes(), 0U);
  EXPECT_THAT(reader.read(input({"back"}), kAlways).error().message, HasSubstr("masks_back"));
}

TEST_F(RecordedClip, RunsFromTheFilesToScores) {
  const BodySource bodies = [](const std::string&) -> Result<std::shared_ptr<const BodyModel>> {
    return std::make_shared<const BodyModel>(make_test_body());
  };
  RunSettings settings;
  settings.frames = 4;
  settings.clip = {"walk/masks_front"};
  settings.camera = "walk/camera.toml";
  settings.camera_names = {"front"};
  settings.truth = "walk";
  settings.segmenter = "masks";
  settings.tracker = {{"evidence", std::string("silhouette")}};
  ASSERT_TRUE(check_clip_files(settings, data_).ok());
  TrackingRuns first(bodies, data_), second(bodies, data_);
  RunSettings other = settings;
  other.clip = {"walk/masks_side"};
  other.camera_names = {"side"};
  ASSERT_TRUE(second.run(other, 3, kAlways).value().has_value());
  const RunResult a = first.run(settings, 3, kAlways).value().value();
  const RunResult b = second.run(settings, 3, kAlways).value().value();
  EXPECT_GT(a.scores.at("observed_iou"), 0.7);
  EXPECT_EQ(a.scores.at("frames"), 4);
  EXPECT_GT(a.scores.at("frames_per_second"), 0);
  for (const char* score : {"pose_error_deg", "visual_accuracy", "observed_iou"}) {
    EXPECT_EQ(a.scores.at(score), b.scores.at(score)) << score;  // whatever ran before
  }
  EXPECT_FALSE(first.run(settings, 3, [] { return false; }).value().has_value());

  RunSettings wrong = settings;
  wrong.camera_names = {"back"};
  EXPECT_THAT(first.run(wrong, 3, kAlways).error().message, HasSubstr("no camera back"));
  wrong.camera_names = {};
  EXPECT_THAT(first.run(wrong, 3, kAlways).error().message, HasSubstr("2 cameras for 1 videos"));
  wrong = settings;
  wrong.truth = "nowhere";
  EXPECT_THAT(first.run(wrong, 3, kAlways).error().message, HasSubstr("nowhere"));
  EXPECT_THAT(check_clip_files(wrong, data_).error().message, HasSubstr("nowhere: no such file"));
}

TEST_F(RecordedClip, CameraOfJson) {
  const std::string text =
      R"({"width": 160, "height": 120, "K": [[200, 0, 80.5], [0, 210, 61], [0, 0, 1]], "dist": [0.1, 0, 0, 0],
          "R_world_to_cam": [[1, 0, 0], [0, -1, 0], [0, 0, -1]], "t_world_to_cam_m": [0, 0.5, 4]})";
  write("camera.json", text);
  RunSettings settings;
  settings.clip = {"a.mp4"};
  settings.camera = "camera.json";
  const std::vector<PinholeCamera> cameras = read_clip_cameras(settings, data_).value();
  ASSERT_EQ(cameras.size(), 1U);
  EXPECT_EQ(cameras[0].distortion[0], 0.1);
  const Eigen::Vector2d pixel = cameras[0].project({0, 1.5, 0}).value();  // y down: -1; z: 4
  EXPECT_NEAR(pixel.x(), 80.5, 1e-9);
  EXPECT_NEAR(pixel.y(), 61 - 210 * 0.25 * (1 + 0.1 / 16), 1e-9);
  std::string bad = text;
  bad.replace(bad.find("[1, 0, 0], [0, -1"), 9, "[2, 0, 0]");
  write("camera.json", bad);
  EXPECT_THAT(read_clip_cameras(settings, data_).error().message, HasSubstr("camera.json: no camera"));
  write("camera.json", "{}");
  EXPECT_THAT(read_clip_cameras(settings, data_).error().message, HasSubstr("camera.json: no camera"));
}

TEST_F(RecordedClip, SurfacesOfNumberedMeshes) {
  const auto mesh = [](std::initializer_list<float> heights) {
    std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(heights.size()) +
                        "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    for (const float y : heights) {
      const float x[3] = {1, y, 2};
      bytes.append(reinterpret_cast<const char*>(x), sizeof x);
    }
    return bytes;
  };
  write("meshes/mesh-f00011.ply", mesh({-1, 0.5F, 0.25F}));
  write("meshes/mesh-f00001.ply", mesh({3}));
  RunSettings settings;
  settings.truth = "meshes";
  settings.truth_above = 0;
  const ClipTruth truth = read_clip_truth(settings, data_, *sequence_.body).value();
  EXPECT_FALSE(truth.joints.has_value());
  ASSERT_EQ(truth.surfaces.size(), 2U);
  EXPECT_EQ(truth.surfaces[0].frame, 0);
  EXPECT_EQ(truth.surfaces[1].frame, 10);
  EXPECT_THAT(truth.surfaces[1].points, ElementsAre(Eigen::Vector3f(1, 0.5F, 2), Eigen::Vector3f(1, 0.25F, 2)));
  settings.truth_above = 1;
  EXPECT_THAT(read_clip_truth(settings, data_, *sequence_.body).error().message, HasSubstr("no vertex that counts"));
}

}  // namespace
}  // namespace silpose
