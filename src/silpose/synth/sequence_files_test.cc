#include "silpose/synth/sequence_files.h"

#include <gmock/gmock.h>

#include <fstream>

#include "silpose/body/test_body.h"
#include "silpose/geometry/calibration_file.h"
#include "silpose/image/image_file.h"
#include "silpose/synth/test_scene.h"
#include "silpose/video/video.h"

namespace silpose {
namespace {

namespace fs = std::filesystem;

class SequenceFiles : public testing::Test {
 protected:
  void SetUp() override { fs::remove_all(directory_); }
  void TearDown() override { fs::remove_all(directory_); }
  fs::path directory_ = fs::temp_directory_path() /
                        (std::string("silpose_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

class StopAfter : public ProgressSink {
 public:
  explicit StopAfter(int64_t frames) : frames_(frames) {}
  bool update(std::string_view, int64_t done, int64_t) override { return done < frames_; }

 private:
  int64_t frames_;
};

TEST_F(SequenceFiles, DegradedMasksLeaveTheTablesTrue) {
  const SyntheticSequence sequence = make_test_scene(6, 1);
  const MaskNoise noise{.fault = MaskFault::kEdge, .iou = 0.85, .outline = {}, .seed = 1};
  const std::vector<DegradedMasks> masks = {DegradedMasks::create(sequence, 0, noise).value()};
  ASSERT_EQ(write_sequence(directory_, sequence, std::nullopt, nullptr, masks).value(), 7);
  double sum = 0;
  for (int frame = 1; frame < 7; ++frame) {
    const Mask written = read_mask(directory_ / "masks" / fmt::format("{:06}.png", frame)).value();
    EXPECT_EQ(written, masks[0].draw(frame));
    sum += intersection_over_union(written, true_mask(sequence, 0, frame));
  }
  EXPECT_NEAR(sum / 6, 0.85, 0.01);
  const std::vector<DegradedMasks> two = {masks[0], masks[0]};
  const PoseTable poses = read_poses(directory_ / "poses.csv", sequence.body->skeleton).value();
  for (size_t d = 0; d < 8; ++d) EXPECT_NEAR(poses.rows[5].values[d], sequence.poses[5][d], 1e-6);
  EXPECT_THROW((void)write_sequence(directory_, sequence, std::nullopt, nullptr, two), std::invalid_argument);
}

TEST_F(SequenceFiles, ReadBackAsTheyWere) {
  const SyntheticSequence sequence = make_test_scene(10, 3);
  ASSERT_EQ(write_sequence(directory_, sequence, ColourOptions{}).value(), 13);

  const PoseTable poses = read_poses(directory_ / "poses.csv", sequence.body->skeleton).value();
  ASSERT_EQ(poses.rows.size(), 10u);
  EXPECT_EQ(poses.rows[0].frame, 3);
  EXPECT_NEAR(poses.rows[0].time_s, 0.1, 1e-6);
  EXPECT_FALSE(poses.has_scores);
  for (size_t d = 0; d < 8; ++d) EXPECT_NEAR(poses.rows[9].values[d], sequence.poses[9][d], 1e-6);
  const PoseTable npsu =
      read_poses(directory_ / "poses_normalised.csv", sequence.body->skeleton, PoseUnits::kNormalised).value();
  EXPECT_NEAR(npsu.rows[9].values[4], sequence.body->skeleton.normalise(sequence.poses[9])[4], 1e-6);

  const JointTable joints = read_joints(directory_ / "joints.csv").value();
  ASSERT_EQ(joints.rows.size(), 10 * landmark_names(*sequence.body).size());
  EXPECT_EQ(joints.rows[0].joint, "root");
  EXPECT_EQ(joints.rows[0].frame, 3);

  const std::vector<PinholeCamera> cameras = load_cameras(directory_ / "camera.toml").value();
  ASSERT_EQ(cameras.size(), 1u);
  const Eigen::Vector2d pixel = cameras[0].project(joints.rows[0].x_in_world).value();
  EXPECT_NEAR((pixel - joints.rows[0].pixel).norm(), 0, 1e-2);

  EXPECT_EQ(read_mask(directory_ / "masks" / "000002.png").value().count(), 0);
  for (const int frame : {3, 12}) {
    EXPECT_EQ(read_mask(directory_ / "masks" / fmt::format("{:06}.png", frame)).value(), true_mask(sequence, 0, frame));
  }
  Video video = open_video((directory_ / "video.mp4").string()).value();
  int num_frames = 0;
  for (const Frame& frame : video) num_frames += frame.images[0].width() == 160;
  EXPECT_EQ(num_frames, 13);
}

TEST_F(SequenceFiles, HaveOneSetOfMasksForEachCamera) {
  auto body = std::make_shared<const BodyModel>(make_test_body());
  SyntheticMotionOptions motion;
  motion.num_frames = 3;
  SceneOptions scene;
  scene.width = 80, scene.height = 60, scene.focal_px = 90;
  scene.views = {{"front", 0}, {"45", 45}};
  const SyntheticSequence sequence = make_sequence(body, make_motion("sway", *body, motion).value(), scene).value();
  ASSERT_TRUE(write_sequence(directory_, sequence).ok());
  EXPECT_EQ(read_mask(directory_ / "masks_front" / "000001.png").value(), true_mask(sequence, 0, 1));
  EXPECT_EQ(read_mask(directory_ / "masks_45" / "000001.png").value(), true_mask(sequence, 1, 1));
  EXPECT_FALSE(fs::exists(directory_ / "masks"));
  EXPECT_FALSE(fs::exists(directory_ / "video_front.mp4"));
  EXPECT_EQ(load_cameras(directory_ / "camera.toml").value()[1].name, "45");
}

TEST_F(SequenceFiles, DescribeTheFramesDoneWhenStopped) {
  const SyntheticSequence sequence = make_test_scene(20);
  StopAfter stop(5);
  const int done = write_sequence(directory_, sequence, std::nullopt, &stop).value();
  EXPECT_GE(done, 5);
  EXPECT_LT(done, 20);
  EXPECT_EQ(read_poses(directory_ / "poses.csv", sequence.body->skeleton).value().rows.size(),
            static_cast<size_t>(done));
  EXPECT_FALSE(fs::exists(directory_ / "masks" / "000019.png"));
}

TEST_F(SequenceFiles, NameWhatCannotBeWritten) {
  std::ofstream(directory_) << "a file";
  const auto written = write_sequence(directory_, make_test_scene(2));
  ASSERT_FALSE(written.ok());
  EXPECT_THAT(written.error().message, testing::HasSubstr(directory_.string()));
}

}  // namespace
}  // namespace silpose
