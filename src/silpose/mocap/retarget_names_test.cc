#include "silpose/mocap/retarget_names.h"

#include <gmock/gmock.h>

namespace silpose {
namespace {

TEST(FindPart, KnowsTheNamesOfCommonRigs) {
  const std::vector<std::string> cmu = {"Hips",  "LHipJoint",    "LeftUpLeg", "LeftLeg",    "Neck",
                                        "Neck1", "LeftShoulder", "LeftArm",   "LeftForeArm"};
  EXPECT_EQ(find_part(cmu, "root"), 0);
  EXPECT_EQ(find_part(cmu, "left_thigh"), 2);
  EXPECT_EQ(find_part(cmu, "left_shin"), 3);
  EXPECT_EQ(find_part(cmu, "neck"), 4);
  EXPECT_EQ(find_part(cmu, "left_upper_arm"), 7);
  EXPECT_EQ(find_part(cmu, "left_forearm"), 8);
  EXPECT_EQ(find_part(cmu, "right_thigh"), std::nullopt);
  EXPECT_EQ(find_part(cmu, "left_wing"), std::nullopt);
  EXPECT_EQ(find_part({"mixamorig:Hips", "mixamorig:RightUpLeg"}, "right_thigh"), 1);
  EXPECT_EQ(find_part({"root", "__UpLeg_L", "UpLeg_L", "LoLeg_L"}, "left_thigh"), 2);
  EXPECT_EQ(find_part({"root", "__UpLeg_L", "UpLeg_L", "LoLeg_L"}, "left_shin"), 3);
  EXPECT_EQ(find_part({"root", "lowerarm01.R", "wrist.R"}, "right_hand"), 2);
  EXPECT_EQ(find_part({"Bip01 L Thigh", "Bip01 R Thigh"}, "right_thigh"), 1);
  EXPECT_EQ(find_part({"hip", "lCollar", "lShldr", "lForeArm"}, "left_upper_arm"), 2);
  EXPECT_EQ(find_part({"Hips", "LeftHip", "LeftKnee"}, "left_thigh"), 1);
  EXPECT_EQ(find_part({"right_shoulder", "right_upper_arm"}, "right_upper_arm"), 1);
  const std::vector<std::string> humanoid3d = {
      "root", "neck", "head", "right_hip", "right_knee", "right_ankle", "right_shoulder", "right_elbow", "right_wrist"};
  int joint_idx = 0;
  for (const char* part : {"root", "neck", "head", "right_thigh", "right_shin", "right_foot", "right_upper_arm",
                           "right_forearm", "right_hand"}) {
    EXPECT_EQ(find_part(humanoid3d, part), joint_idx++) << part;
  }
}

}  // namespace
}  // namespace silpose
