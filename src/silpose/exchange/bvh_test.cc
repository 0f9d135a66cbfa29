#include "silpose/exchange/bvh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "silpose/base/folder_for_test.h"
#include "silpose/base/rng.h"

namespace silpose {
namespace {

using Eigen::Vector3d;
using testing::AllOf;
using testing::HasSubstr;

class Bvh : public FolderTest {
 protected:
  Result<Clip> read(const std::string& text) {
    std::ofstream(path_, std::ios::binary) << text;
    return read_bvh(path_);
  }

  const std::filesystem::path path_ = folder_ / "clip.bvh";
};

// Two joints and an end site, one joint with its channels out of the usual order, tabs, blanks and CRLF.
const std::string kSmall =
    "HIERARCHY\r\nROOT Bip01 Pelvis\r\n{\r\n\tOFFSET 0 0 0\r\n"
    "\tCHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation \r\n"
    "\tJOINT ns:Spine {\r\n OFFSET\t0 2 0\r\n CHANNELS 3 Xrotation Zrotation Yrotation\r\n"
    "\tEnd Site\r\n{ OFFSET 0 1 0 }\r\n}\r\n}\r\n"
    "MOTION\r\nFrames:\t2\r\nFrame Time: .0083333\r\n"
    " 1 2 3 0 0 0 0 0 0 \r\n1e1 -2 +3 90 0 0 90 90 0\r\n\r\n";

TEST_F(Bvh, ReadsASmallFileByHand) {
  const Clip clip = read(kSmall).value();
  ASSERT_EQ(clip.num_joints(), 3U);
  EXPECT_THAT(clip.joint_names(), testing::ElementsAre("Bip01 Pelvis", "ns:Spine", "ns:Spine_end"));
  EXPECT_EQ(clip.joints[1].parent_idx, 0);
  EXPECT_EQ(clip.joints[2].parent_idx, 1);
  EXPECT_TRUE(clip.joints[2].is_end);
  EXPECT_EQ(clip.fps, 120);
  ASSERT_EQ(clip.num_frames(), 2U);
  EXPECT_TRUE(clip.forward_kinematics(0)[2].isApprox(Vector3d(1, 5, 3)));
  // Frame 1: the root's quarter turn about z lays the spine along -x; in the spine's frame Rx(90) Rz(90) takes the
  // end's y to -x (by Rz) and leaves it there (Rx); the root's turn takes -x to -y.
  const auto positions = clip.forward_kinematics(1);
  EXPECT_TRUE(positions[0].isApprox(Vector3d(10, -2, 3), 1e-12));
  EXPECT_TRUE(positions[1].isApprox(Vector3d(8, -2, 3), 1e-12));
  EXPECT_TRUE(positions[2].isApprox(Vector3d(8, -3, 3), 1e-12));
}

TEST_F(Bvh, KeepsTheOffsetWherePositionsAreNotUsed) {
  const auto text = [](const std::string& row) {
    return "HIERARCHY\nROOT a\n{\nOFFSET 0 5 0\nCHANNELS 6 Xposition Yposition Zposition Xrotation Yrotation "
           "Zrotation\n"
           "JOINT b\n{\nOFFSET 0 2 0\nCHANNELS 6 Xposition Yposition Zposition Xrotation Yrotation Zrotation\n}\n}\n"
           "MOTION\nFrames: 1\nFrame Time: 0.04\n" +
           row + "\n";
  };
  EXPECT_TRUE(read(text("0 0 0 0 0 0 0 0 0 0 0 0")).value().forward_kinematics(0)[1].isApprox(Vector3d(0, 2, 0)));
  EXPECT_TRUE(read(text("1 1 1 0 0 0 0 3 0 0 0 0")).value().forward_kinematics(0)[1].isApprox(Vector3d(1, 4, 1)));
}

TEST_F(Bvh, ReadsWholeFrameRatesFromRoundedTimes) {
  const std::vector<std::pair<std::string, double>> cases = {
      {"0.0083333", 120}, {"0.008333", 120}, {"0.0333333", 30},          {"0.041667", 24},
      {"0.016666", 60},   {"0.04", 25},      {"0.033367", 1 / 0.033367}, {"0.008342", 1 / 0.008342}};
  for (const auto& [time, fps] : cases) {
    std::string text = kSmall;
    text.replace(text.find(".0083333"), 8, time);
    EXPECT_NEAR(read(text).value().fps, fps, 1e-9) << time;
  }
}

// A chain of `depth` joints, one frame.
std::string chain(int depth) {
  std::string text = "HIERARCHY\n";
  for (int j = 0; j < depth; ++j) {
    text += fmt::format("{} j{}\n{{\nOFFSET 0 1 0\nCHANNELS 1 Zrotation\n", j ? "JOINT" : "ROOT", j);
  }
  text += std::string(static_cast<size_t>(depth), '}') + "\nMOTION\nFrames: 1\nFrame Time: 0.01\n";
  for (int j = 0; j < depth; ++j) text += "0 ";
  return text;
}

TEST_F(Bvh, ReadsHundredsOfJoints) {
  const Clip clip = read(chain(900)).value();
  EXPECT_EQ(clip.num_joints(), 900U);
  EXPECT_NEAR(clip.forward_kinematics(0).back().y(), 900, 1e-9);
  EXPECT_THAT(read(chain(10001)).error().message, HasSubstr("more than 10000 joints"));
}

// Few bytes a frame and many joints would fill the memory.
TEST_F(Bvh, RefusesMoreThanMemoryHolds) {
  std::string text = "HIERARCHY\nROOT j\n{\nOFFSET 0 1 0\nCHANNELS 1 Zrotation\n";
  for (int j = 1; j < 10000; ++j) text += "JOINT j\n{\nOFFSET 0 1 0\n";
  text += std::string(10000, '}') + "\nMOTION\nFrames: 20000\nFrame Time: 0.01\n";
  for (int frame = 0; frame < 20000; ++frame) text += "0\n";
  EXPECT_THAT(read(text).error().message, HasSubstr("more than 100000000 joints times frames"));
}

TEST_F(Bvh, NamesFileLineAndWhatIsWrong) {
  const auto with = [](const std::string& old_text, const std::string& new_text) {
    std::string text = kSmall;
    return text.replace(text.find(old_text), old_text.size(), new_text);
  };
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"RIFF\x01\x02", "line 1: not BVH: 'RIFF\x01\x02' where HIERARCHY should be"},
      {"\n\nHIERARCHY\n", "line 4: the end of the file where ROOT should be"},
      {"HIERARCHY\nMOTION\n", "line 2: 'MOTION' where ROOT should be"},
      {with("ROOT Bip01 Pelvis", "ROOT "), "line 2: a joint without a name"},
      {with("OFFSET 0 0 0", "OFFSET 0 zero 0"), "line 4: OFFSET of 'Bip01 Pelvis': 'zero' is not a number up to 1e9"},
      {with("OFFSET\t0 2 0", "OFFSET\t0 nan 0"), "line 7: OFFSET of 'ns:Spine': 'nan' is not a number up to 1e9"},
      {with("OFFSET 0 0 0", ""), "line 5: 'CHANNELS' where the OFFSET of 'Bip01 Pelvis' should be"},
      {with("CHANNELS 6", "CHANNELS 9"), "line 5: CHANNELS of 'Bip01 Pelvis': '9' is not a number from 0 to 6"},
      {with("Zposition", "Zscale"), "line 5: CHANNELS of 'Bip01 Pelvis': unknown channel 'Zscale'"},
      {with("}\r\n}\r\nMOTION", "}\r\nMOTION"), "line 12: 'MOTION' where JOINT, End Site or } should be"},
      {with("}\r\n}\r\nMOTION", "}\r\n}\r\n}\r\nMOTION"), "line 13: '}' where MOTION should be"},
      {with("OFFSET 0 1 0 }", "OFFSET 0 1 0 JOINT x { OFFSET 0 0 0 } }"), "a joint inside an end site"},
      {with("\tEnd Site", "\tElbow x"), "line 9: 'Elbow' where JOINT, End Site or } should be"},
      {with("Frames:\t2", "Frames:\t-2"), "line 14: Frames: '-2' is not a number of frames"},
      {with("Frames:\t2", "Frames:\t0"), "line 14: holds no frame"},
      {with("Frames:\t2", "Frames:\t3"), "ends in frame 3 of 3"},
      {with("Frames:\t2", "Frames:\t1"), "line 17: '1e1' after the last of 1 frames"},
      {with(".0083333", "0"), "line 15: Frame Time: '0' is not a positive number of seconds"},
      {with(".0083333", "2e3"), "line 15: Frame Time: '2e3' is not within 1e-05 to 1000 seconds"},
      {with(".0083333", "inf"), "line 15: Frame Time: 'inf' is not a positive number of seconds"},
      {with("Frame Time", "Frame Rate"), "line 15: 'Rate' where 'Frame Time:' should be"},
      {with(" 1 2 3 0", " 1 2 3 nan"), "line 16: frame 1: 'nan' is not a number up to 1e9"},
      {with("1e1 -2", "1e1 -2,5"), "line 17: frame 2: '-2,5' is not a number up to 1e9"},
      {with("1e1 -2", "1e999 -2"), "line 17: frame 2: '1e999' is not a number up to 1e9"},
      {with(" 1 2 3 0", " 1 2 3"), "line 16: frame 1: fewer than 9 values in the line"},
      {with(" 1 2 3 0", " 1 2 3 4 0"), "line 16: frame 1: more than 9 values in the line"},
      {kSmall.substr(0, kSmall.find("\tEnd")), "ends inside joint 'ns:Spine'"},
      {kSmall.substr(0, kSmall.find("1e1") + 8), "frame 2"}};
  for (const auto& [text, message] : cases) {
    const auto clip = read(text);
    ASSERT_FALSE(clip.ok()) << message;
    EXPECT_THAT(clip.error().message, AllOf(HasSubstr(path_.string()), HasSubstr(message)));
    EXPECT_EQ(clip.error().message.find('\n'), std::string::npos);
  }
  EXPECT_THAT(read("").error().message, HasSubstr("is empty"));
  EXPECT_THAT(read_bvh("no/such.bvh").error().message, HasSubstr("no/such.bvh: no such file"));
}

TEST_F(Bvh, AFrameCountThatCannotBeDoesNotFillTheMemory) {
  std::string text = kSmall;
  EXPECT_THAT(read(text.replace(text.find("Frames:\t2"), 9, "Frames: 999999999")).error().message,
              HasSubstr("ends in frame 3 of 999999999"));
}

TEST_F(Bvh, CutAnywhereGivesAnErrorAndNoCrash) {
  const size_t whole = kSmall.find_last_not_of("\r\n") + 1;
  for (size_t length = 0; length < whole - 1; ++length) EXPECT_FALSE(read(kSmall.substr(0, length)).ok()) << length;
}

Dof rotation(const std::string& name, int joint, const Vector3d& axis) {
  return {.name = name,
          .joint_idx = joint,
          .is_translation = false,
          .is_periodic = false,
          .axis = axis,
          .lower = -kPi,
          .upper = kPi};
}

// A trunk with two arms whose joints are not in depth-first order, as our human's do not.
Skeleton small_skeleton() {
  std::vector<Joint> joints = {{"root", -1, {0, 0.9, 0}, {0, 1, 2, 3, 4}},
                               {"chest", 0, {0, 0.4, 0.02}, {5, 6, 7}},
                               {"hip", 0, {0.1, -0.1, 0}, {8, 9}},
                               {"arm", 1, {0.2, 0.1, 0}, {10, 11, 12}},
                               {"fixed", 1, {0, 0.2, 0}, {}}};
  std::vector<Dof> dofs;
  dofs.reserve(13);
  for (int axis = 0; axis < 3; ++axis) {
    dofs.push_back({.name = std::string("root_t") + "xyz"[axis],
                    .joint_idx = 0,
                    .is_translation = true,
                    .is_periodic = false,
                    .axis = Vector3d::Unit(axis),
                    .lower = -5,
                    .upper = 5});
  }
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  dofs.push_back(rotation("root_ry", 0, y));
  dofs.push_back(rotation("root_rx", 0, x));
  dofs.push_back(rotation("chest_rx", 1, -x));
  dofs.push_back(rotation("chest_ry", 1, y));
  dofs.push_back(rotation("chest_rz", 1, z));
  dofs.push_back(rotation("hip_rx", 2, x));
  dofs.push_back(rotation("hip_rz", 2, -z));
  dofs.push_back(rotation("arm_rz", 3, z));
  dofs.push_back(rotation("arm_rx", 3, x));
  dofs.push_back(rotation("arm_ry", 3, y));
  return Skeleton("small", std::move(joints), std::move(dofs));
}

// small_skeleton() whose joints have axes of their own at rest.
Skeleton turned_skeleton() {
  const Skeleton skeleton = small_skeleton();
  std::vector<Joint> joints(skeleton.joints().begin(), skeleton.joints().end());
  for (size_t j = 0; j < joints.size(); ++j) {
    const double angle = 0.4 + 0.7 * static_cast<double>(j);
    joints[j].parent_from_rest = Eigen::AngleAxisd(angle, Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  }
  return Skeleton("turned", std::move(joints), {skeleton.dofs().begin(), skeleton.dofs().end()});
}

class BvhOfRig : public Bvh, public testing::WithParamInterface<bool> {};
INSTANTIATE_TEST_SUITE_P(Axes, BvhOfRig, testing::Bool(),
                         [](const auto& param) { return param.param ? "OfItsOwn" : "OfTheWorld"; });

TEST_P(BvhOfRig, WrittenPosesComeBackWithinATenthOfAMillimetre) {
  const Skeleton skeleton = GetParam() ? turned_skeleton() : small_skeleton();
  Rng rng(7);
  std::vector<std::vector<double>> poses;
  for (int frame = 0; frame < 300; ++frame) {
    std::vector<double> pose;
    for (const Dof& dof : skeleton.dofs()) pose.push_back(rng.uniform(dof.lower, dof.upper));
    poses.push_back(pose);
  }
  poses.push_back(std::vector<double>(13, 0.0));
  poses.push_back(std::vector<double>(13, kPi / 2));  // where the written angles are not unique
  const std::vector<BodyModel::EndPoint> ends = {{"finger", 3, {0.3, 0.01, 0}}};
  ASSERT_TRUE(write_bvh(path_, clip_from_poses(skeleton, poses, 30, ends)).ok());
  const Clip clip = read_bvh(path_).value();
  EXPECT_EQ(clip.fps, 30);
  ASSERT_EQ(clip.num_frames(), poses.size());
  for (size_t frame = 0; frame < poses.size(); ++frame) {
    const auto expected = skeleton.forward_kinematics(poses[frame]);
    const auto positions = clip.forward_kinematics(frame);
    for (int j = 0; j < skeleton.num_joints(); ++j) {
      const auto at = clip.find_joint(skeleton.joints()[static_cast<size_t>(j)].name);
      ASSERT_TRUE(at.has_value());
      EXPECT_LT((positions[static_cast<size_t>(*at)] - expected[static_cast<size_t>(j)].translation).norm(), 1e-5);
    }
    const auto end = static_cast<size_t>(clip.find_joint("arm_end").value());
    EXPECT_LT((positions[end] - expected[3] * ends[0].offset_in_joint).norm(), 1e-5);
  }
}

TEST_F(Bvh, WrittenClipComesBackTheSame) {
  const Clip clip = read(kSmall).value();
  ASSERT_TRUE(write_bvh(path_, clip).ok());
  const Clip again = read_bvh(path_).value();
  EXPECT_EQ(again.joint_names(), clip.joint_names());
  EXPECT_EQ(again.fps, clip.fps);
  for (size_t frame = 0; frame < clip.num_frames(); ++frame) {
    for (size_t j = 0; j < clip.num_joints(); ++j) {
      EXPECT_LT((again.forward_kinematics(frame)[j] - clip.forward_kinematics(frame)[j]).norm(), 1e-6);
    }
  }
}

TEST_F(Bvh, WrittenAnglesDoNotJump) {
  const Skeleton skeleton = small_skeleton();
  std::vector<std::vector<double>> poses;
  for (int frame = 0; frame < 100; ++frame) {
    poses.emplace_back(13, 0.0);
    poses.back()[10] = 0.1 * frame;  // more than one whole turn about z
  }
  ASSERT_TRUE(write_bvh(path_, clip_from_poses(skeleton, poses, 30)).ok());
  std::ifstream stream(path_);
  std::string line, last;
  while (std::getline(stream, line)) last = line;
  EXPECT_THAT(last, HasSubstr(fmt::format(" {:.6f}", to_degrees(9.9))));
}

TEST_F(Bvh, WrittenAnglesGoOnPastARightAngleOfTheMiddleAxis) {
  const Skeleton skeleton = small_skeleton();
  std::vector<std::vector<double>> poses;
  for (int frame = 0; frame < 30; ++frame) {
    poses.emplace_back(13, 0.0);
    poses.back()[11] = 0.1 * frame;  // arm_rx, up to 166 degrees
  }
  ASSERT_TRUE(write_bvh(path_, clip_from_poses(skeleton, poses, 30)).ok());
  std::ifstream stream(path_);
  std::string line, last;
  while (std::getline(stream, line)) last = line;
  EXPECT_THAT(last, HasSubstr(fmt::format(" 0.000000 {:.6f} 0.000000", to_degrees(2.9))));
}

TEST_F(Bvh, SaysWhereItCannotWriteAndRefusesWrongPoses) {
  const Skeleton skeleton = small_skeleton();
  const std::vector<std::vector<double>> poses = {std::vector<double>(13, 0.0)}, wrong = {{1, 2, 3}};
  EXPECT_THAT(write_bvh("no/such/place.bvh", clip_from_poses(skeleton, poses, 30)).error().message,
              HasSubstr("no/such/place.bvh: cannot be written"));
  EXPECT_THROW((void)clip_from_poses(skeleton, wrong, 30), std::invalid_argument);
  EXPECT_THROW((void)clip_from_poses(skeleton, poses, 0), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
