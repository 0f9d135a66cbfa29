#include "silpose/motion/noise.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string_view>

#include "silpose/base/check.h"
#include "silpose/geometry/rigid3.h"

namespace silpose {
namespace {

struct Row {
  std::string_view dof;  // without its side
  double deviation;      // degrees, or metres for translations
};

// Random walk: deviation of the change within kNoiseInterval_s. [guess] A walker moves 45 mm per frame in a steady
// direction and bobs by 25 mm twice per stride; hips and knees turn by up to 8 degrees per frame. The deviations are
// smaller: the weights select the particles that moved far enough. Twists move little and hardly change a silhouette.
constexpr Row kHumanNoise[] = {
    {"root_tx", 0.020},  {"root_ty", 0.010}, {"root_tz", 0.020}, {"root_rx", 1},      {"root_ry", 2},
    {"root_rz", 1},      {"abdomen_rx", 1},  {"thorax_rx", 1},   {"thorax_ry", 2},    {"thorax_rz", 1},
    {"head_rx", 2},      {"head_ry", 2},     {"head_rz", 1},     {"thigh_rx", 4},     {"thigh_ry", 2},
    {"thigh_rz", 2},     {"shin_rx", 5},     {"foot_rx", 3},     {"upper_arm_rx", 4}, {"upper_arm_ry", 3},
    {"upper_arm_rz", 4}, {"forearm_rx", 5},  {"forearm_ry", 2},  {"hand_rx", 3},      {"hand_rz", 3},
};

// Acceleration: deviation of the change of velocity within kNoiseInterval_s, times that interval. [guess] for walking,
// running and dancing.
constexpr Row kHumanAcceleration[] = {
    {"root_tx", 0.008},  {"root_ty", 0.008},  {"root_tz", 0.008},  {"root_rx", 1},      {"root_ry", 1},
    {"root_rz", 1},      {"abdomen_rx", 0.5}, {"thorax_rx", 0.75}, {"thorax_ry", 1},    {"thorax_rz", 0.75},
    {"head_rx", 1},      {"head_ry", 1},      {"head_rz", 1},      {"thigh_rx", 2},     {"thigh_ry", 1.5},
    {"thigh_rz", 1.5},   {"shin_rx", 3.5},    {"foot_rx", 3},      {"upper_arm_rx", 2}, {"upper_arm_ry", 1.5},
    {"upper_arm_rz", 2}, {"forearm_rx", 2},   {"forearm_ry", 1.5}, {"hand_rx", 1.5},    {"hand_rz", 1.5},
};

// Prior about the rest pose: deviation of joints from hanging straight down, facing ahead, as people stand, walk and
// gesture. [guess] for each DOF; the scale of the table was [tuned on walks with masks of an IoU of 0.9]: 0.3 of its
// weight did not help, half of it and more did (docs/notebook/tracking.md).
constexpr Row kHumanPose[] = {
    {"root_rx", 15},      {"root_rz", 12},      {"abdomen_rx", 10}, {"thorax_rx", 10},  {"thorax_ry", 12},
    {"thorax_rz", 8},     {"head_rx", 15},      {"head_ry", 20},    {"head_rz", 10},    {"thigh_rx", 30},
    {"thigh_ry", 12},     {"thigh_rz", 12},     {"shin_rx", 35},    {"foot_rx", 15},    {"upper_arm_rx", 40},
    {"upper_arm_ry", 30}, {"upper_arm_rz", 35}, {"forearm_rx", 45}, {"forearm_ry", 25}, {"hand_rx", 15},
    {"hand_rz", 10},
};

// Where limb directions are measured, the prior of these joints is this many times wider: people who sit or squat are
// not pulled upright. [tuned on nine takes of five people]
constexpr std::string_view kSeenByDirections[] = {"thigh_rx", "shin_rx"};
constexpr double kLoosened = 3;

std::optional<double> find_row(std::span<const Row> table, const Dof& dof) {
  const auto row = std::ranges::find(table, without_side(dof.name), &Row::dof);
  return row == table.end() ? std::nullopt : std::optional(row->deviation);
}

// In degrees or metres.
double typical_deviation(const Dof& dof) {
  if (const auto row = find_row(kHumanNoise, dof)) return *row;
  if (dof.is_translation) return std::abs(dof.axis.y()) > 0.5 ? 0.010 : 0.020;
  if (dof.is_periodic) return 2;
  return std::clamp(0.03 * to_degrees(dof.upper - dof.lower), 1.0, 5.0);
}

// In degrees or metres.
double typical_acceleration(const Dof& dof) {
  if (const auto row = find_row(kHumanAcceleration, dof)) return *row;
  if (dof.is_translation) return 0.008;
  return 0.5 * typical_deviation(dof);
}

}  // namespace

std::vector<double> noise_deviation(const Skeleton& skeleton, double sigma_deg) {
  check(std::isfinite(sigma_deg) && sigma_deg > 0, "noise: sigma of {} degrees", sigma_deg);
  std::vector<double> deviation;
  for (const Dof& dof : skeleton.dofs()) {
    const double typical = typical_deviation(dof) * sigma_deg / kTypicalSigmaDeg;
    deviation.push_back(dof.is_translation ? typical : to_radians(typical));
  }
  return deviation;
}

std::vector<double> acceleration_deviation(const Skeleton& skeleton) {
  std::vector<double> deviation;
  for (const Dof& dof : skeleton.dofs()) {
    const double typical = typical_acceleration(dof);
    deviation.push_back(dof.is_translation ? typical : to_radians(typical));
  }
  return deviation;
}

std::vector<double> pose_deviation(const Skeleton& skeleton, bool directions_seen) {
  std::vector<double> deviation;
  for (const Dof& dof : skeleton.dofs()) {
    if (const auto row = find_row(kHumanPose, dof)) {
      const bool is_seen = directions_seen && std::ranges::count(kSeenByDirections, without_side(dof.name)) > 0;
      deviation.push_back(to_radians(*row) * (is_seen ? kLoosened : 1));
    } else {
      const bool anywhere = dof.is_translation || dof.is_shape || dof.is_periodic || dof.joint_idx == 0;
      deviation.push_back(anywhere ? 0 : 0.25 * (dof.upper - dof.lower));
    }
  }
  return deviation;
}

}  // namespace silpose
