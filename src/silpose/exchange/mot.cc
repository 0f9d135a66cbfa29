#include "silpose/exchange/mot.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "silpose/base/check.h"
#include "silpose/base/text_file.h"
#include "silpose/exchange/unwrapped_euler.h"

namespace silpose {
namespace {

// Where the generic model has the middle between its hip joints, in its pelvis frame, metres.
const Eigen::Vector3d kHipsInPelvis(-0.056276, -0.07849, 0);

constexpr const char* kPelvisNames[] = {"pelvis_tilt", "pelvis_list", "pelvis_rotation",
                                        "pelvis_tx",   "pelvis_ty",   "pelvis_tz"};
constexpr const char* kLegNames[] = {"hip_flexion#",     "hip_adduction#", "hip_rotation#",   "knee_angle#",
                                     "knee_angle#_beta", "ankle_angle#",   "subtalar_angle#", "mtp_angle#"};
constexpr const char* kLumbarNames[] = {"lumbar_extension", "lumbar_bending", "lumbar_rotation"};
constexpr const char* kArmNames[] = {"arm_flex#", "arm_add#",    "arm_rot#",  "elbow_flex#",
                                     "pro_sup#",  "wrist_flex#", "wrist_dev#"};

constexpr std::array<const char*, 2> kMiddleJoints = {"root", "thorax"};
constexpr std::array<const char*, 6> kSideJoints = {"thigh", "shin", "foot", "upper_arm", "forearm", "hand"};

std::vector<std::string> coordinate_names() {
  std::vector<std::string> names;
  const auto add = [&](const auto& some, const std::string& side) {
    for (std::string name : some) {
      if (const size_t at = name.find('#'); at != std::string::npos) name.replace(at, 1, side);
      names.push_back(std::move(name));
    }
  };
  add(kPelvisNames, "");
  for (const char* side : {"_r", "_l"}) add(kLegNames, side);
  add(kLumbarNames, "");
  for (const char* side : {"_r", "_l"}) add(kArmNames, side);
  return names;
}

// The coordinates of one pose after the other.
class Coordinates {
 public:
  explicit Coordinates(const Skeleton& skeleton) : skeleton_(skeleton) {
    // Columns: the model's X forward, Y up, Z right in our joint's frame. The axes of a left limb are the mirror images
    // of the right one's. The model's zero has palms forward, ours has them to the thighs.
    right_ << 0, 0, -1, 0, 1, 0, 1, 0, 0;
    left_ = right_ * Eigen::Vector3d(1, 1, -1).asDiagonal();
    hand_from_limb_ << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  }

  // In the order of coordinate_names(), degrees and metres.
  std::vector<double> of(const std::vector<double>& pose) {
    world_from_joint_ = skeleton_.forward_kinematics(pose);
    next_ = 0;
    values_.clear();
    // The pelvis turns in the ground, whose axes are the world's.
    const Rigid3& root = world_from_joint_[joint("root")];
    const Eigen::Matrix3d world_from_pelvis = root.rotation * right_;
    put(degrees(world_from_pelvis));
    const Eigen::Vector3d hips = 0.5 * (world_from_joint_[joint("right_thigh")].translation +
                                        world_from_joint_[joint("left_thigh")].translation);
    put(hips - world_from_pelvis * kHipsInPelvis);
    put_leg("right_", right_);
    put_leg("left_", left_);
    put(degrees("root", "thorax", right_));
    put_arm("right_", right_);
    put_arm("left_", left_);
    return values_;
  }

 private:
  size_t joint(const std::string& name) const { return static_cast<size_t>(skeleton_.find_joint(name).value()); }

  void put(const Eigen::Vector3d& values) { values_.insert(values_.end(), values.begin(), values.end()); }

  // About Z, X and Y of the model.
  Eigen::Vector3d degrees(const Eigen::Matrix3d& parent_from_child) {
    return angles_.at(next_++).next(parent_from_child) * to_degrees(1);
  }
  Eigen::Vector3d degrees(const std::string& parent, const std::string& child,
                          const Eigen::Matrix3d& joint_from_model) {
    return degrees(joint_from_model.transpose() * world_from_joint_[joint(parent)].rotation.transpose() *
                   world_from_joint_[joint(child)].rotation * joint_from_model);
  }

  void put_leg(const std::string& side, const Eigen::Matrix3d& joint_from_model) {
    put(degrees("root", side + "thigh", joint_from_model));
    const double knee = -degrees(side + "thigh", side + "shin", joint_from_model)[0];
    const double ankle = degrees(side + "shin", side + "foot", joint_from_model)[0];
    values_.insert(values_.end(), {knee, knee, ankle, 0, 0});
  }

  void put_arm(const std::string& side, const Eigen::Matrix3d& joint_from_model) {
    put(degrees("thorax", side + "upper_arm", joint_from_model));
    const Eigen::Vector3d elbow = degrees(side + "upper_arm", side + "forearm", joint_from_model);
    const Eigen::Vector3d wrist = degrees(side + "forearm", side + "hand", joint_from_model * hand_from_limb_);
    values_.insert(values_.end(), {elbow[0], 90 + elbow[2], wrist[0], wrist[1]});
  }

  const Skeleton& skeleton_;
  Eigen::Matrix3d right_, left_, hand_from_limb_;
  std::vector<Rigid3> world_from_joint_;
  std::array<SteadyAngles, 14> angles_;  // of the model's joints in the order in which they are asked for
  size_t next_ = 0;
  std::vector<double> values_;
};

}  // namespace

bool has_opensim_coordinates(const Skeleton& skeleton) {
  const auto has = [&](const std::string& name) { return skeleton.find_joint(name).has_value(); };
  return std::all_of(kMiddleJoints.begin(), kMiddleJoints.end(), has) &&
         std::all_of(kSideJoints.begin(), kSideJoints.end(),
                     [&](const std::string& name) { return has("right_" + name) && has("left_" + name); });
}

Result<void> write_mot(const std::filesystem::path& path, const Skeleton& skeleton, const PoseTable& poses) {
  check(has_opensim_coordinates(skeleton), "write_mot: '{}' is not the human's skeleton", skeleton.name());
  const std::vector<std::string> names = coordinate_names();
  std::string text = fmt::format(
      "Coordinates\nversion=1\nnRows={}\nnColumns={}\ninDegrees=yes\n"
      "Coordinates of Rajagopal2016; metres, seconds, degrees; the ground is the world of joints.csv.\nendheader\ntime",
      poses.rows.size(), names.size() + 1);
  for (const std::string& name : names) text += '\t' + name;
  text += '\n';
  Coordinates coordinates(skeleton);
  for (const PoseTable::Row& row : poses.rows) {
    fmt::format_to(std::back_inserter(text), "{:.6f}", row.time_s);
    for (const double value : coordinates.of(row.values)) fmt::format_to(std::back_inserter(text), "\t{:.6f}", value);
    text += '\n';
  }
  return write_text_file(path, text);
}

}  // namespace silpose
