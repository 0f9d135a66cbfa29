#include "silpose/motion/common_poses.h"

#include <algorithm>
#include <initializer_list>
#include <numeric>
#include <span>
#include <string_view>

#include "silpose/base/check.h"
#include "silpose/geometry/rigid3.h"

namespace silpose {
namespace {

constexpr int kNumHeadings = 8;  // [guess]

struct Angle {
  std::string_view dof;  // "both_" stands for right and left
  double degrees;
};

struct NamedPose {
  std::string_view name;
  std::vector<Angle> angles;
};

const std::vector<NamedPose>& named_poses() {
  static const std::vector<NamedPose> poses = {
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
  return poses;
}

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

}  // namespace

CommonPoses::CommonPoses(const Skeleton& skeleton) {
  const std::optional<int> heading_dof = skeleton.find_dof("root_ry");
  const int num_headings = heading_dof ? kNumHeadings : 1;
  std::vector<std::vector<double>> found;
  for (const NamedPose& named : named_poses()) {
    for (int heading = 0; heading < num_headings; ++heading) {
      std::vector<double> pose(static_cast<size_t>(skeleton.num_dofs()), 0.0);
      for (const Angle& angle : named.angles) set_angle(skeleton, angle.dof, angle.degrees, pose);
      if (heading_dof) pose[static_cast<size_t>(*heading_dof)] = to_radians(360.0 * heading / kNumHeadings);
      skeleton.clamp(pose);
      if (std::find(found.begin(), found.end(), pose) != found.end()) continue;
      found.push_back(std::move(pose));
      names_.emplace_back(named.name);
    }
  }
  poses_.resize(static_cast<Eigen::Index>(found.size()), skeleton.num_dofs());
  for (size_t k = 0; k < found.size(); ++k) {
    std::copy(found[k].begin(), found[k].end(), poses_.row(static_cast<Eigen::Index>(k)).data());
  }
}

StateBatch CommonPoses::propose(const Observation&, int num_candidates, Rng& rng) const {
  check(num_candidates >= 0, "CommonPoses: {} candidates", num_candidates);
  if (num_candidates == 0 || num_candidates >= poses_.rows()) return poses_;
  std::vector<Eigen::Index> order(static_cast<size_t>(poses_.rows()));
  std::iota(order.begin(), order.end(), 0);
  StateBatch chosen(num_candidates, poses_.cols());
  for (Eigen::Index k = 0; k < num_candidates; ++k) {
    const auto at = static_cast<size_t>(k);
    std::swap(order[at], order[at + rng.index(order.size() - at)]);
    chosen.row(k) = poses_.row(order[at]);
  }
  return chosen;
}

}  // namespace silpose
