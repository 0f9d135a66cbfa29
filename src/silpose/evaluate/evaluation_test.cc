#include "silpose/evaluate/evaluation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "silpose/body/human_profile.h"
#include "silpose/body/test_body.h"
#include "silpose/geometry/calibration_file.h"
#include "silpose/image/image_file.h"
#include "silpose/render/silhouette.h"

namespace silpose {
namespace {

using testing::AllOf;
using testing::HasSubstr;
namespace fs = std::filesystem;

JointTable::Row joint(int64_t frame, const std::string& name, const Eigen::Vector3d& x,
                      const Eigen::Vector2d& pixel = {NAN, NAN}) {
  return {.frame = frame, .time_s = 0.1 * static_cast<double>(frame), .joint = name, .x_in_world = x, .pixel = pixel};
}

PoseTable::Row pose(int64_t frame, double tip_rx_deg) {
  PoseTable::Row row{.frame = frame, .time_s = 0.1 * static_cast<double>(frame), .values = std::vector<double>(8, 0.0)};
  row.values[6] = to_radians(tip_rx_deg);
  return row;
}

const BodyModel& body() {
  static const BodyModel model = [] {
    BodyModel tube = make_test_body();
    const RigProfile human = human_profile(tube.skeleton);
    tube.profile.landmarks = human.landmarks;
    tube.profile.origin = human.origin;
    return tube;
  }();
  return model;
}

class EvaluateFiles : public testing::Test {
 protected:
  void SetUp() override {
    directory_ = fs::path(testing::TempDir()) /
                 (std::string("evaluate_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(directory_);
    fs::create_directories(directory_ / "result" / "masks");
    fs::create_directories(directory_ / "truth" / "masks");
  }
  void TearDown() override { fs::remove_all(directory_); }
  fs::path directory_;
};

TEST(Evaluate, MatchesFramesByNumberAndTakesMeanAndSpread) {
  Recorded result, truth;
  truth.poses = PoseTable{.rows = {pose(2, 0), pose(3, 0), pose(4, 0), pose(9, 0)}};
  result.poses = PoseTable{.rows = {pose(0, 80), pose(3, 4), pose(4, -8), pose(5, 70)}};
  const Evaluation evaluation = evaluate(result, truth, body()).value();
  EXPECT_EQ(evaluation.frames, 2);
  EXPECT_EQ(evaluation.frames_missing, 2);
  EXPECT_NEAR(evaluation.find("pose_error_deg")->mean, 6, 1e-9);
  EXPECT_NEAR(evaluation.find("pose_error_deg")->std, 2, 1e-9);
  EXPECT_NEAR(evaluation.find("angle_error_deg")->mean, 6.0 / 5, 1e-9);
  EXPECT_FALSE(evaluation.find("joint_error_mm").has_value());
  EXPECT_FALSE(evaluation.find("visual_accuracy").has_value());
  EXPECT_FALSE(evaluation.find("mask_iou").has_value());
  std::vector<std::string> names;
  for (const auto& [name, figure] : evaluation.figures) names.push_back(name);
  EXPECT_THAT(names, testing::ElementsAre("pose_error_npsu", "pose_error_deg", "angle_error_deg", "joint_error_mm",
                                          "joint_error_root_mm", "joint_error_aligned_mm", "joint_error_px",
                                          "visual_accuracy", "mask_iou"));
}

TEST(Evaluate, FrameByFrame) {
  Recorded result, truth;
  truth.poses = PoseTable{.rows = {pose(2, 0), pose(3, 0), pose(4, 0)}};
  result.poses = PoseTable{.rows = {pose(3, 4), pose(4, -8)}};
  const auto frames = evaluate_frames(result, truth, body()).value();
  ASSERT_EQ(frames.size(), 2u);
  EXPECT_EQ(frames[1].frame, 4);
  ASSERT_EQ(frames[1].values.size(), figure_names().size());
  EXPECT_EQ(figure_names()[1], "pose_error_deg");
  EXPECT_NEAR(frames[1].values[1].value(), 8, 1e-9);
  EXPECT_FALSE(frames[1].values[3].has_value());
}

TEST(Evaluate, StartAndEndAreTheTruthsTimes) {
  Recorded result, truth;
  for (int64_t frame = 0; frame < 10; ++frame) {
    if (!truth.poses) truth.poses = result.poses = PoseTable{};
    truth.poses->rows.push_back(pose(frame, 0));
    if (frame != 6) result.poses->rows.push_back(pose(frame, static_cast<double>(frame)));
  }
  const Evaluation evaluation = evaluate(result, truth, body(), {.start_s = 0.3, .end_s = 0.7}).value();  // 3 4 5 (6)
  EXPECT_EQ(evaluation.frames, 3);
  EXPECT_EQ(evaluation.frames_missing, 1);
  EXPECT_NEAR(evaluation.find("pose_error_deg")->mean, 4, 1e-9);
  EXPECT_THROW((void)evaluate(result, truth, body(), {.start_s = 1, .end_s = 1}), std::invalid_argument);
}

TEST(Evaluate, JointErrorsByHand) {
  Recorded result, truth;
  result.joints = truth.joints = JointTable{};
  // Hips move by (0, 0, 30 mm), the head by (40 mm, 0, 30 mm); thorax and an unknown joint do not count.
  const Eigen::Vector3d shift(0, 0, 0.03);
  for (const auto& [name, x] : std::vector<std::pair<std::string, Eigen::Vector3d>>{
           {"right_thigh", {-0.1, 1, 0}}, {"left_thigh", {0.1, 1, 0}}, {"head_top", {0, 1.8, 0}}}) {
    truth.joints->rows.push_back(joint(0, name, x, {100, 200}));
    const bool is_head = name == "head_top";
    result.joints->rows.push_back(joint(0, name, x + shift + Eigen::Vector3d(is_head ? 0.04 : 0, 0, 0),
                                        is_head ? Eigen::Vector2d(NAN, NAN) : Eigen::Vector2d(103, 204)));
  }
  truth.joints->rows.push_back(joint(0, "thorax", {0, 0, 0}));
  result.joints->rows.push_back(joint(0, "thorax", {9, 9, 9}));
  result.joints->rows.push_back(joint(0, "left_hand", {9, 9, 9}));  // the truth lacks it
  const Evaluation evaluation = evaluate(result, truth, body()).value();
  EXPECT_EQ(evaluation.frames, 1);
  EXPECT_NEAR(evaluation.find("joint_error_mm")->mean, (30 + 30 + 50) / 3.0, 1e-9);
  EXPECT_NEAR(evaluation.find("joint_error_root_mm")->mean, 40 / 3.0, 1e-9);
  EXPECT_LT(evaluation.find("joint_error_aligned_mm")->mean, 40 / 3.0);
  EXPECT_NEAR(evaluation.find("joint_error_px")->mean, 5, 1e-9);
  EXPECT_FALSE(evaluation.find("pose_error_deg").has_value());
}

TEST(Evaluate, ARigIsEvaluatedByItsOwnLandmarks) {
  const BodyModel tube = make_test_body();  // root, middle, tip, tip_end, about the root
  Recorded result, truth;
  result.joints = truth.joints = JointTable{};
  for (const auto& [name, off] : {std::pair{"root", 0.01}, {"middle", 0.02}, {"tip_end", 0.03}}) {
    truth.joints->rows.push_back(joint(0, name, {0, 1, 0}));
    result.joints->rows.push_back(joint(0, name, {off, 1, 0}));
  }
  const Evaluation evaluation = evaluate(result, truth, tube).value();
  EXPECT_NEAR(evaluation.find("joint_error_mm")->mean, 20, 1e-9);
  EXPECT_NEAR(evaluation.find("joint_error_root_mm")->mean, 10, 1e-9);
}

TEST(Evaluate, ImagesOfTwoCamerasAreNotCompared) {
  Recorded result, truth;
  truth.joints = JointTable{.rows = {joint(0, "left_hand", {0, 1, 1}, {100, 200})}};
  result.joints = truth.joints;
  truth.cameras = result.cameras = {look_at_camera(64, 96, 150, {0, 0.75, 3}, {0, 0.75, 0})};
  truth.cameras[0].name = "north";
  EXPECT_TRUE(evaluate(result, truth, body()).value().find("joint_error_px").has_value());
  result.cameras[0].name = "south";
  EXPECT_FALSE(evaluate(result, truth, body()).value().find("joint_error_px").has_value());
}

TEST(Evaluate, WithoutAHipThereIsNoRootError) {
  Recorded result, truth;
  truth.joints = JointTable{.rows = {joint(0, "left_thigh", {0, 1, 0}), joint(0, "left_hand", {0, 1, 1})}};
  result.joints = truth.joints;
  const Evaluation evaluation = evaluate(result, truth, body()).value();
  EXPECT_EQ(evaluation.find("joint_error_mm")->mean, 0);
  EXPECT_FALSE(evaluation.find("joint_error_root_mm").has_value());
  EXPECT_FALSE(evaluation.find("joint_error_aligned_mm").has_value());
  EXPECT_FALSE(evaluation.find("joint_error_px").has_value());
}

TEST_F(EvaluateFiles, ReadsDirectoriesAndComparesMasks) {
  const PinholeCamera camera = look_at_camera(64, 96, 150, {0, 0.75, 3}, {0, 0.75, 0});
  PoseTable poses{.rows = {pose(0, 0), pose(1, 20)}};
  ASSERT_TRUE(write_poses(directory_ / "truth" / "poses.csv", body().skeleton, poses).ok());
  ASSERT_TRUE(write_cameras(directory_ / "truth" / "camera.toml", {camera}).ok());
  const auto file = [&](const char* side, int frame) {
    return directory_ / side / "masks" / fmt::format("{:06d}.png", frame);
  };
  const Mask upright = render_silhouette(body(), camera, poses.rows[0].values);
  ASSERT_GT(upright.count(), 100);
  for (int frame = 0; frame < 2; ++frame) {
    ASSERT_TRUE(write_mask(file("truth", frame), render_silhouette(body(), camera, poses.rows[frame].values)).ok());
  }
  Mask half = upright;
  for (int y = 0; y < 96; ++y) {
    for (int x = 0; x < 32; ++x) half.set(x, y, false);
  }
  ASSERT_TRUE(write_mask(file("result", 0), half).ok());
  poses.has_scores = true;
  ASSERT_TRUE(write_poses(directory_ / "result" / "poses.csv", body().skeleton, poses).ok());

  Recorded result = read_recorded(directory_ / "result", body()).value();
  const Recorded truth = read_recorded(directory_ / "truth", body()).value();
  EXPECT_EQ(truth.mask_files.size(), 2U);
  const Evaluation evaluation = evaluate(result, truth, body()).value();
  EXPECT_EQ(evaluation.frames, 2);
  EXPECT_NEAR(evaluation.find("pose_error_deg")->mean, 0, 1e-5);
  EXPECT_NEAR(evaluation.find("visual_accuracy")->mean, 1, 1e-9);
  EXPECT_EQ(evaluation.find("mask_iou")->mean,
            static_cast<double>(half.count()) / static_cast<double>(upright.count()));

  // A result that leans where the truth is upright.
  result.poses->rows[0] = pose(0, 40);
  const auto leaning = render_silhouette(body(), camera, result.poses->rows[0].values);
  const Figure accuracy = evaluate(result, truth, body()).value().find("visual_accuracy").value();
  const double expected = intersection_over_union(leaning, upright);
  EXPECT_LT(expected, 1);
  EXPECT_NEAR(accuracy.mean, (expected + 1) / 2, 1e-9);
  EXPECT_NEAR(accuracy.std, (1 - expected) / 2, 1e-9);
}

TEST_F(EvaluateFiles, ATruthOfMasksAloneStillCounts) {
  ASSERT_TRUE(write_mask(directory_ / "truth" / "masks" / "000003.png", mask_from_text("##\n..")).ok());
  ASSERT_TRUE(write_mask(directory_ / "truth" / "masks" / "000004.png", mask_from_text("##\n..")).ok());
  ASSERT_TRUE(write_mask(directory_ / "result" / "masks" / "000003.png", mask_from_text("#.\n#.")).ok());
  std::ofstream(directory_ / "result" / "masks" / "note.txt") << "not a mask";
  const Evaluation evaluation = evaluate(read_recorded(directory_ / "result", body()).value(),
                                         read_recorded(directory_ / "truth", body()).value(), body())
                                    .value();
  EXPECT_EQ(evaluation.frames, 1);
  EXPECT_EQ(evaluation.frames_missing, 1);
  EXPECT_NEAR(evaluation.find("mask_iou")->mean, 1.0 / 3, 1e-12);
}

TEST_F(EvaluateFiles, LandmarksMayHaveTheNamesOfOpenPose) {
  BodyModel tube = make_test_body();
  tube.profile.landmarks[1].other_names = {{"openpose", "MidHip"}};
  std::ofstream(directory_ / "truth" / "joints.csv") << "frame,time_s,joint,x_m,y_m,z_m\n7,0,MidHip,1,2,3\n";
  const Recorded truth = read_recorded(directory_ / "truth", tube).value();
  ASSERT_EQ(truth.joints->rows.size(), 1U);
  EXPECT_EQ(truth.joints->rows[0].joint, "middle");
}

TEST_F(EvaluateFiles, NamesWhatIsWrong) {
  const auto message = [&](const fs::path& path) { return read_recorded(path, body()).error().message; };
  EXPECT_THAT(message("no/such/dir"), HasSubstr("no/such/dir: no such directory"));
  EXPECT_THAT(message(directory_), HasSubstr("holds neither"));
  std::ofstream(directory_ / "truth" / "poses.csv") << "frame,time_s\n";
  EXPECT_THAT(message(directory_ / "truth"), AllOf(HasSubstr("poses.csv"), HasSubstr("'root_tx_m' is missing")));

  fs::remove(directory_ / "truth" / "poses.csv");
  std::ofstream(directory_ / "truth" / "joints.csv") << "frame,time_s,joint,x_m,y_m,z_m\n7,0,knee,1,2,3\n";
  EXPECT_THAT(message(directory_ / "truth"), HasSubstr("joints.csv: frame 7: unknown joint 'knee'"));
  fs::remove(directory_ / "truth" / "joints.csv");

  ASSERT_TRUE(write_mask(directory_ / "truth" / "masks" / "000003.png", mask_from_text("##\n..")).ok());
  ASSERT_TRUE(write_mask(directory_ / "result" / "masks" / "000003.png", mask_from_text("##")).ok());
  Recorded result = read_recorded(directory_ / "result", body()).value();
  const Recorded truth = read_recorded(directory_ / "truth", body()).value();
  EXPECT_THAT(evaluate(result, truth, body()).error().message, AllOf(HasSubstr("000003.png"), HasSubstr("2 x 1")));
  result.poses = PoseTable{.rows = {pose(3, 0)}};
  result.cameras = {default_camera(64, 48)};
  EXPECT_THAT(evaluate(result, truth, body()).error().message, HasSubstr("camera 'camera' has 64 x 48"));
}

}  // namespace
}  // namespace silpose
