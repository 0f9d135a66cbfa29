#include "silpose/exchange/humanoid3d.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "silpose/exchange/clip_file.h"

namespace silpose {
namespace {

using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;

// One frame as the file has it, standing 0.9 m high; the indices are the file's.
using Values = std::array<double, 44>;
constexpr size_t kRoot = 4, kChest = 8, kRightKnee = 20, kRightElbow = 29, kLeftHip = 30, kLeftKnee = 34,
                 kLeftElbow = 43;

Values standing(double duration_s = 0.02) {
  Values values{};
  values[0] = duration_s, values[2] = 0.9;
  for (const size_t w : {kRoot, kChest, 12UL, 16UL, 21UL, 25UL, kLeftHip, 35UL, 39UL}) values[w] = 1;
  return values;
}

class Humanoid3d : public testing::Test {
 protected:
  void SetUp() override {
    path_ = std::filesystem::path(testing::TempDir()) /
            (std::string("humanoid3d_") + testing::UnitTest::GetInstance()->current_test_info()->name() + ".txt");
  }
  void TearDown() override { std::filesystem::remove(path_); }

  Result<Clip> read_text(const std::string& text) {
    std::ofstream(path_, std::ios::binary) << text;
    return read_humanoid3d(path_);
  }

  Result<Clip> read(const std::vector<Values>& frames) {
    std::string text = "{\"Loop\": \"wrap\",\n\"Frames\":\n[\n";
    for (const Values& frame : frames) {
      text += &frame == frames.data() ? "[" : ",\n[";
      for (size_t i = 0; i < frame.size(); ++i) text += fmt::format("{}{:.9f}", i == 0 ? "\t" : ",\t", frame[i]);
      text += "]";
    }
    return read_text(text + "\n]\n}\n");
  }

  static Vector3d at(const Clip& clip, const char* joint, size_t frame = 0) {
    return clip.forward_kinematics(frame)[static_cast<size_t>(clip.find_joint(joint).value())];
  }

  std::filesystem::path path_;
};

TEST_F(Humanoid3d, StandsUprightFacingXWithItsLeftAtMinusZ) {
  const Clip clip = read({standing(), standing(0)}).value();
  EXPECT_EQ(clip.num_frames(), 2U);
  EXPECT_NEAR(clip.fps, 50, 1e-9);
  EXPECT_NEAR(at(clip, "root").y(), 0.9, 1e-12);
  EXPECT_NEAR(at(clip, "right_ankle").y(), 0.9 - 0.421546 - 0.40987, 1e-9);  // 7 cm above the floor
  EXPECT_GT(at(clip, "head").y(), 1.5);
  EXPECT_LT(at(clip, "left_shoulder").z(), -0.18);
  EXPECT_GT(at(clip, "right_wrist").z(), 0.18);
  EXPECT_GT(at(clip, "left_toe").x(), at(clip, "left_ankle").x() + 0.1);
}

TEST_F(Humanoid3d, BendsKneesBackAndElbowsForth) {
  Values bent = standing();
  bent[kRightKnee] = -kPi / 2, bent[kRightElbow] = kPi / 2;
  bent[kLeftKnee] = -kPi / 6, bent[kLeftElbow] = kPi / 6;
  const Clip clip = read({bent, bent}).value();
  EXPECT_TRUE(at(clip, "right_ankle").isApprox(at(clip, "right_knee") - Vector3d(0.40987, 0, 0), 1e-6));
  EXPECT_TRUE(at(clip, "right_wrist").isApprox(at(clip, "right_elbow") + Vector3d(0.258947, 0, 0), 1e-6));
  EXPECT_NEAR(at(clip, "left_ankle").x(), at(clip, "left_knee").x() - 0.40987 / 2, 1e-6);
  EXPECT_NEAR(at(clip, "left_wrist").x(), at(clip, "left_elbow").x() + 0.258947 / 2, 1e-6);
}

TEST_F(Humanoid3d, TakesQuaternionsAsWXYZ) {
  Values turned = standing();
  const double half = std::sqrt(0.5);
  turned[kRoot] = half, turned[kRoot + 2] = half;        // a quarter turn about y: forward is now -z
  turned[kLeftHip] = half, turned[kLeftHip + 3] = half;  // about z: the thigh points forward
  turned[kChest] = -half, turned[kChest + 1] = -half;    // about x, the other sign: the chest leans to the right
  const Clip clip = read({turned}).value();
  EXPECT_TRUE((at(clip, "left_knee") - at(clip, "left_hip")).isApprox(Vector3d(0, 0, -0.421546), 1e-5));
  EXPECT_TRUE((at(clip, "neck") - at(clip, "chest")).isApprox(Vector3d(0.223894, 0, 0), 1e-5));
}

TEST_F(Humanoid3d, ResamplesFramesOfUnequalDuration) {
  std::vector<Values> frames = {standing(0.1), standing(0.05), standing(0.1), standing(0)};
  for (size_t t = 0; t < 4; ++t) frames[t][1] = std::array{0.0, 2.0, 3.0, 5.0}[t];  // 20 m/s
  const Clip clip = read(frames).value();
  EXPECT_NEAR(clip.fps, 20, 1e-9);
  ASSERT_EQ(clip.num_frames(), 6U);
  for (size_t i = 0; i < 6; ++i) EXPECT_NEAR(at(clip, "root", i).x(), static_cast<double>(i), 1e-9);
}

TEST_F(Humanoid3d, RoundingOfDurationsIsNoReasonToResample) {
  EXPECT_EQ(read({standing(0.016666), standing(0.016667), standing(0.0)}).value().num_frames(), 3U);
}

TEST_F(Humanoid3d, NamesWhatIsWrong) {
  const auto message = [&](const std::vector<Values>& frames) { return read(frames).error().message; };
  Values bad = standing();
  bad[kChest] = 0.05;
  EXPECT_THAT(message({standing(), bad}), AllOf(HasSubstr(path_.filename().string()), HasSubstr("frame 1: chest")));
  EXPECT_THAT(message({standing(0), standing()}), HasSubstr("frame 0: lasts 0 s"));
  EXPECT_THAT(message({standing(1e-5), standing(1000), standing()}), HasSubstr("frames from"));
  bad = standing();
  bad[3] = 1e300;
  EXPECT_THAT(message({bad}), HasSubstr("value 4"));
  EXPECT_THAT(message({}), HasSubstr("no frame"));
  EXPECT_THAT(read_text("{\"Frames\": [[1, 2]]}").error().message, HasSubstr("2 values, not 44"));
  EXPECT_THAT(read_text("{\"Frames\": [{\"a\": 1}]}").error().message, HasSubstr("frame 0"));
  EXPECT_THAT(read_text("{\"Frames\": 3}").error().message, HasSubstr("not a humanoid3d motion"));
  EXPECT_THAT(read_text("some text").error().message, HasSubstr("not JSON"));
  EXPECT_THAT(read_text("").error().message, HasSubstr("not JSON"));
  EXPECT_THAT(read_humanoid3d(path_.string() + ".none").error().message, HasSubstr(".none"));
}

TEST_F(Humanoid3d, IsRecognisedByItsName) {
  ASSERT_TRUE(read({standing()}));
  EXPECT_EQ(read_clip(path_).value().num_frames(), 1U);
  EXPECT_TRUE(is_clip_file("a/b.BVH"));
  EXPECT_FALSE(is_clip_file("sway"));
  EXPECT_THAT(read_clip("walk.fbx").error().message, HasSubstr("walk.fbx"));
}

}  // namespace
}  // namespace silpose
