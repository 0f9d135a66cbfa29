#include "silpose/body/human_profile.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "silpose/base/check.h"
#include "silpose/geometry/rigid3.h"

namespace silpose {
namespace {

struct DeviationRow {
  std::string_view dof;  // without its side
  double deviation;      // degrees, or metres for translations
};

// Random walk: deviation of the change within kNoiseInterval_s. [guess] A walker moves 45 mm per frame in a steady
// direction and bobs by 25 mm twice per stride; hips and knees turn by up to 8 degrees per frame. The deviations are
// smaller: the weights select the particles that moved far enough. Twists move little and hardly change a silhouette.
constexpr DeviationRow kHumanNoise[] = {
    {"root_tx", 0.020},  {"root_ty", 0.010}, {"root_tz", 0.020}, {"root_rx", 1},      {"root_ry", 2},
    {"root_rz", 1},      {"abdomen_rx", 1},  {"thorax_rx", 1},   {"thorax_ry", 2},    {"thorax_rz", 1},
    {"head_rx", 2},      {"head_ry", 2},     {"head_rz", 1},     {"thigh_rx", 4},     {"thigh_ry", 2},
    {"thigh_rz", 2},     {"shin_rx", 5},     {"foot_rx", 3},     {"upper_arm_rx", 4}, {"upper_arm_ry", 3},
    {"upper_arm_rz", 4}, {"forearm_rx", 5},  {"forearm_ry", 2},  {"hand_rx", 3},      {"hand_rz", 3},
};

// Acceleration: deviation of the change of velocity within kNoiseInterval_s, times that interval. [guess] for walking,
// running and dancing.
constexpr DeviationRow kHumanAcceleration[] = {
    {"root_tx", 0.008},  {"root_ty", 0.008},  {"root_tz", 0.008},  {"root_rx", 1},      {"root_ry", 1},
    {"root_rz", 1},      {"abdomen_rx", 0.5}, {"thorax_rx", 0.75}, {"thorax_ry", 1},    {"thorax_rz", 0.75},
    {"head_rx", 1},      {"head_ry", 1},      {"head_rz", 1},      {"thigh_rx", 2},     {"thigh_ry", 1.5},
    {"thigh_rz", 1.5},   {"shin_rx", 3.5},    {"foot_rx", 3},      {"upper_arm_rx", 2}, {"upper_arm_ry", 1.5},
    {"upper_arm_rz", 2}, {"forearm_rx", 2},   {"forearm_ry", 1.5}, {"hand_rx", 1.5},    {"hand_rz", 1.5},
};

// Prior about the rest pose: deviation of joints from hanging straight down, facing ahead, as people stand, walk and
// gesture. [guess] for each DOF; the scale of the table was [tuned on walks with masks of an IoU of 0.9]: 0.3 of its
// weight did not help, half of it and more did (docs/notebook/tracking.md).
constexpr DeviationRow kHumanPose[] = {
    {"root_rx", 15},      {"root_rz", 12},      {"abdomen_rx", 10}, {"thorax_rx", 10},  {"thorax_ry", 12},
    {"thorax_rz", 8},     {"head_rx", 15},      {"head_ry", 20},    {"head_rz", 10},    {"thigh_rx", 30},
    {"thigh_ry", 12},     {"thigh_rz", 12},     {"shin_rx", 35},    {"foot_rx", 15},    {"upper_arm_rx", 40},
    {"upper_arm_ry", 30}, {"upper_arm_rz", 35}, {"forearm_rx", 45}, {"forearm_ry", 25}, {"hand_rx", 15},
    {"hand_rz", 10},
};

// Where directions of the limbs are seen, those who sit and squat are not held upright.
// [tuned: nine takes of five people]
constexpr std::string_view kSeenByDirections[] = {"thigh_rx", "shin_rx"};
constexpr double kLoosened = 3;

std::optional<double> find_row(std::span<const DeviationRow> table, const Dof& dof) {
  const auto row = std::ranges::find(table, without_side(dof.name), &DeviationRow::dof);
  return row == table.end() ? std::nullopt : std::optional(row->deviation);
}

struct Angle {
  std::string_view dof;  // "both_" stands for right and left
  double degrees = 0;
};

struct PoseRow {
  std::string_view name;
  Angle angles[10];  // the last ones without a name
};

constexpr PoseRow kPoses[] = {
    {"standing", {{"both_upper_arm_rz", 8}, {"both_forearm_rx", 10}}},
    {"right stride",
     {{"right_thigh_rx", 28},
      {"right_shin_rx", 8},
      {"left_thigh_rx", -18},
      {"left_shin_rx", 20},
      {"left_foot_rx", -10},
      {"right_upper_arm_rx", -20},
      {"left_upper_arm_rx", 22},
      {"both_upper_arm_rz", 6},
      {"right_forearm_rx", 15},
      {"left_forearm_rx", 30}}},
    {"left stride",
     {{"left_thigh_rx", 28},
      {"left_shin_rx", 8},
      {"right_thigh_rx", -18},
      {"right_shin_rx", 20},
      {"right_foot_rx", -10},
      {"left_upper_arm_rx", -20},
      {"right_upper_arm_rx", 22},
      {"both_upper_arm_rz", 6},
      {"left_forearm_rx", 15},
      {"right_forearm_rx", 30}}},
    {"right leg passing",
     {{"right_thigh_rx", 22},
      {"right_shin_rx", 58},
      {"left_shin_rx", 5},
      {"both_upper_arm_rz", 6},
      {"both_forearm_rx", 20}}},
    {"left leg passing",
     {{"left_thigh_rx", 22},
      {"left_shin_rx", 58},
      {"right_shin_rx", 5},
      {"both_upper_arm_rz", 6},
      {"both_forearm_rx", 20}}},
    {"a-pose", {{"both_upper_arm_rz", 42}, {"both_thigh_rz", 6}}},
    {"t-pose", {{"both_upper_arm_rz", 90}}},
    {"arms raised", {{"both_upper_arm_rz", 160}, {"both_forearm_rx", 15}}},
    {"right arm raised", {{"right_upper_arm_rz", 150}, {"left_upper_arm_rz", 8}, {"both_forearm_rx", 20}}},
    {"left arm raised", {{"left_upper_arm_rz", 150}, {"right_upper_arm_rz", 8}, {"both_forearm_rx", 20}}},
    {"arms forward", {{"both_upper_arm_rx", 85}, {"both_forearm_rx", 10}}},
    {"hands on hips",
     {{"both_upper_arm_rz", 45}, {"both_upper_arm_rx", -15}, {"both_upper_arm_ry", 75}, {"both_forearm_rx", 90}}},
    {"elbows bent", {{"both_upper_arm_rz", 10}, {"both_upper_arm_rx", 5}, {"both_forearm_rx", 90}}},
    {"wide stance", {{"both_thigh_rz", 20}, {"both_upper_arm_rz", 20}}},
    {"crouch",
     {{"both_thigh_rx", 50},
      {"both_shin_rx", 75},
      {"both_foot_rx", 25},
      {"abdomen_rx", 20},
      {"thorax_rx", 10},
      {"both_upper_arm_rx", 25},
      {"both_upper_arm_rz", 10},
      {"both_forearm_rx", 40}}},
    {"bent forward", {{"both_thigh_rx", 15}, {"abdomen_rx", 40}, {"thorax_rx", 20}, {"both_upper_arm_rx", 40}}},
    {"sitting",
     {{"both_thigh_rx", 85},
      {"both_thigh_rz", 8},
      {"both_shin_rx", 85},
      {"both_upper_arm_rx", 15},
      {"both_upper_arm_rz", 8},
      {"both_forearm_rx", 60}}},
};

void set_angle(const Skeleton& skeleton, std::string_view name, double degrees, std::vector<double>& pose) {
  constexpr std::string_view kBoth = "both_";
  if (name.starts_with(kBoth)) {
    for (const std::string side : {"right_", "left_"}) {
      set_angle(skeleton, side + std::string(name.substr(kBoth.size())), degrees, pose);
    }
    return;
  }
  if (const std::optional<int> dof = skeleton.find_dof(name)) pose[static_cast<size_t>(*dof)] = to_radians(degrees);
}

struct LandmarkRow {
  const char *name, *openpose;  // empty: it has none
};
// Those that body models and marker sets agree about, with the names of OpenPose's BODY_25.
constexpr LandmarkRow kLandmarks[] = {
    {"right_thigh", "RHip"},
    {"right_shin", "RKnee"},
    {"right_foot", "RAnkle"},
    {"left_thigh", "LHip"},
    {"left_shin", "LKnee"},
    {"left_foot", "LAnkle"},
    {"right_upper_arm", "RShoulder"},
    {"right_forearm", "RElbow"},
    {"right_hand", "RWrist"},
    {"left_upper_arm", "LShoulder"},
    {"left_forearm", "LElbow"},
    {"left_hand", "LWrist"},
    {"head_top", ""},
};

// An upright body covers about a tenth of its height squared. [guess: used since the first tracker, whose starts depend
// on it. Measured for the average person, mean over eight headings: 0.149 in the zero pose, 0.161 with the arms 40
// degrees out]
constexpr double kSilhouetteArea = 0.1;

constexpr const char* kJointNames[] = {"root",           "abdomen",         "thorax",        "head",
                                       "right_hip",      "right_thigh",     "right_shin",    "right_foot",
                                       "left_hip",       "left_thigh",      "left_shin",     "left_foot",
                                       "right_shoulder", "right_upper_arm", "right_forearm", "right_hand",
                                       "left_shoulder",  "left_upper_arm",  "left_forearm",  "left_hand"};

void set_deviations(const Skeleton& skeleton, RigProfile& profile) {
  const auto set = [](std::span<const DeviationRow> table, const Dof& dof, double& deviation) {
    const std::optional<double> row = find_row(table, dof);
    if (row) deviation = dof.is_translation ? *row : to_radians(*row);
  };
  for (size_t d = 0; d < skeleton.dofs().size(); ++d) {
    const Dof& dof = skeleton.dofs()[d];
    set(kHumanNoise, dof, profile.noise[d]);
    set(kHumanAcceleration, dof, profile.acceleration[d]);
    set(kHumanPose, dof, profile.rest[d]);
    const bool is_seen = std::ranges::count(kSeenByDirections, without_side(dof.name)) > 0;
    profile.rest_if_seen[d] = profile.rest[d] * (is_seen ? kLoosened : 1);
  }
}

}  // namespace

bool has_human_joints(const Skeleton& skeleton) {
  return std::ranges::equal(skeleton.joints(), kJointNames,
                            [](const Joint& joint, const char* name) { return joint.name == name; });
}

RigProfile human_profile(const Skeleton& skeleton) {
  RigProfile profile = tree_profile(skeleton);
  profile.facing = Eigen::Vector3d::UnitZ();
  for (const char* foot : {"right_foot", "left_foot"}) {
    if (const std::optional<int> joint = skeleton.find_joint(foot)) profile.contact_joints.push_back(*joint);
  }
  profile.landmarks.clear();
  for (const LandmarkRow& row : kLandmarks) {
    RigProfile::Landmark landmark{.name = row.name};
    if (row.openpose[0] != 0) landmark.other_names["openpose"] = row.openpose;
    profile.landmarks.push_back(std::move(landmark));
  }
  profile.origin = {"right_thigh", "left_thigh"};
  set_deviations(skeleton, profile);
  profile.poses.clear();
  for (const PoseRow& row : kPoses) {
    std::vector<double> pose(static_cast<size_t>(skeleton.num_dofs()), 0.0);
    for (const Angle& angle : row.angles) {
      if (!angle.dof.empty()) set_angle(skeleton, angle.dof, angle.degrees, pose);
    }
    profile.poses.push_back({std::string(row.name), std::move(pose)});
  }
  profile.silhouette_area = kSilhouetteArea;
  return profile;
}

}  // namespace silpose
