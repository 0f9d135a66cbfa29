#include "silpose/mocap/retarget_source.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "silpose/mocap/retarget_names.h"

namespace silpose::retarget_source {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kRestTurn = to_radians(0.5);

int common_ancestor(const Clip& clip, int a, int b) {
  while (a != b) (a > b ? a : b) = clip.joints[static_cast<size_t>(std::max(a, b))].parent_idx;
  return a;
}

double pitch_of(const Vector3d& direction, const Vector3d& up) {
  return std::asin(std::clamp(direction.dot(up) / direction.norm(), -1.0, 1.0));
}

}  // namespace

Result<Parts> find_parts(const Clip& clip) {
  const std::vector<std::string> names = clip.joint_names();
  Parts parts;
  std::string missing;
  const auto need = [&](const std::string& part) {
    const std::optional<int> found = find_part(names, part);
    if (!found) missing += (missing.empty() ? "" : ", ") + part;
    return found.value_or(-1);
  };
  parts.root = need("root");
  parts.head = need("head");
  parts.neck = find_part(names, "neck").value_or(parts.head);
  for (size_t s = 0; s < 2; ++s) {
    const std::string side = kSides[s];
    Parts::Limbs& limbs = parts.side[s];
    limbs = {need(side + "thigh"),     need(side + "shin"),
             need(side + "foot"),      find_part(names, side + "toe").value_or(-1),
             need(side + "upper_arm"), need(side + "forearm"),
             need(side + "hand"),      find_part(names, side + "finger").value_or(-1)};
  }
  if (!missing.empty()) return error("{}: no joint that could be {}", clip.name, missing);
  parts.chest =
      common_ancestor(clip, parts.neck, common_ancestor(clip, parts.side[0].upper_arm, parts.side[1].upper_arm));
  return parts;
}

std::vector<Rigid3> rest_pose(const Clip& clip) {
  std::vector<Rigid3> rest;
  for (const Vector3d& position : clip.rest_positions()) rest.push_back({Matrix3d::Identity(), position});
  return rest;
}

Vector3d middle(std::span<const Rigid3> joints, int a, int b) {
  return (joints[static_cast<size_t>(a)].translation + joints[static_cast<size_t>(b)].translation) / 2;
}

double distance(std::span<const Rigid3> joints, int a, int b) {
  return (joints[static_cast<size_t>(a)].translation - joints[static_cast<size_t>(b)].translation).norm();
}

Matrix3d rest_axes(std::span<const Rigid3> rest, const Parts& parts) {
  const Vector3d hips = middle(rest, parts.side[0].thigh, parts.side[1].thigh);
  Vector3d up = (rest[static_cast<size_t>(parts.neck)].translation - hips).normalized();
  // Captures are laid out along their axes: a spine that leans a little in the rest pose is no reason to tilt the body.
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(up[axis]) > 0.9) up = Vector3d::Unit(axis) * (up[axis] > 0 ? 1 : -1);
  }
  Vector3d left = rest[static_cast<size_t>(parts.side[0].thigh)].translation -
                  rest[static_cast<size_t>(parts.side[1].thigh)].translation;
  left = (left - up * left.dot(up)).normalized();
  Matrix3d axes;
  axes << left, up, left.cross(up);
  return axes;
}

double flat_foot_pitch(const Clip& clip, int foot, int toe, const Vector3d& rest_up, const Vector3d& up) {
  constexpr size_t kFewest = 40;  // frames
  const std::vector<Vector3d> rest = clip.rest_positions();
  const auto from = static_cast<size_t>(foot), to = static_cast<size_t>(toe);
  const double rest_pitch = std::clamp(pitch_of(rest[to] - rest[from], rest_up), to_radians(-45), to_radians(10));
  if (clip.num_frames() < kFewest) return rest_pitch;
  std::vector<std::pair<double, double>> speed_and_pitch;
  std::vector<Vector3d> last;
  for (size_t t = 0; t < clip.num_frames(); ++t) {
    std::vector<Vector3d> x = clip.forward_kinematics(t);
    if (t > 0) {
      speed_and_pitch.emplace_back((x[from] - last[from]).norm() + (x[to] - last[to]).norm(),
                                   pitch_of(x[to] - x[from], up));
    }
    last = std::move(x);
  }
  std::sort(speed_and_pitch.begin(), speed_and_pitch.end());
  std::vector<double> still;
  for (size_t i = 0; i < speed_and_pitch.size() / 4; ++i) still.push_back(speed_and_pitch[i].second);
  std::sort(still.begin(), still.end());
  const double flat = still[still.size() * 9 / 10];
  return std::clamp(flat, rest_pitch - to_radians(25), rest_pitch + to_radians(25));
}

bool is_z_up(const Clip& clip, const Parts& parts, const Vector3d& rest_up) {
  Vector3d mean = Vector3d::Zero();
  for (size_t t = 0; t < clip.num_frames(); ++t) {
    mean += clip.world_from_joint(t)[static_cast<size_t>(parts.root)].rotation * rest_up;
  }
  mean /= static_cast<double>(clip.num_frames());
  const bool rest_says = std::abs(rest_up.z()) > std::abs(rest_up.y());
  const double agreement = rest_says ? mean.z() : mean.y(), other = rest_says ? mean.y() : mean.z();
  return agreement < 0.5 && other > 0.7 ? !rest_says : rest_says;
}

bool opens_at_rest(const Clip& clip) {
  if (clip.num_frames() < 2) return false;
  const auto is_turned = [&](size_t i) {
    return clip.rotations[i].angularDistance(Eigen::Quaterniond::Identity()) > kRestTurn;
  };
  int turned = 0, unturned_before = 0;
  for (size_t j = 0; j < clip.num_joints(); ++j) {
    if (!is_turned(clip.num_joints() + j)) continue;
    ++turned;
    unturned_before += !is_turned(j);
  }
  return 4 * unturned_before >= 3 * turned;
}

std::vector<double> sample_times(const Clip& clip, size_t first, double fps) {
  double frames_per_sample = clip.fps / fps;
  const double whole = std::round(frames_per_sample);
  if (whole >= 1 && std::abs(frames_per_sample - whole) < 0.01 * whole) frames_per_sample = whole;
  std::vector<double> times;
  const auto last = static_cast<double>(clip.num_frames() - 1);
  for (size_t i = 0;; ++i) {
    const double time = static_cast<double>(first) + static_cast<double>(i) * frames_per_sample;
    if (time > last + 1e-6) return times;
    times.push_back(std::min(time, last));
  }
}

}  // namespace silpose::retarget_source
