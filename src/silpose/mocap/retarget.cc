#include "silpose/mocap/retarget.h"

#include <Eigen/Cholesky>
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "silpose/base/check.h"
#include "silpose/body/point_motion.h"
#include "silpose/mocap/retarget_source.h"

namespace silpose {
namespace {

using namespace retarget_source;  // NOLINT: what only this file uses

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kLimbWeight = 1, kTrunkWeight = 0.7, kTipWeight = 0.4;
constexpr double kPullToZero = 1e-4, kPullToLast = 1e-3;  // against limb directions of unit length
constexpr int kIterations = 60;
constexpr double kRestJump = to_radians(5);
constexpr double kStuck = to_radians(5);
constexpr double kMostFrames = 1e6;  // of a retargeted clip

// A direction to match: from a point of one of our joints to a point of another, both fixed to their joints.
struct Segment {
  int from_idx = 0, to_idx = 0;
  Vector3d from_offset = Vector3d::Zero(), to_offset = Vector3d::Zero();
  double weight = 0;
  bool is_limb = false;  // counts in the residual that is reported
  int source_from = 0, source_to = 0;
  std::optional<Vector3d> source_axis;  // instead: this rest direction (clip coordinates), turned by source_from
};

struct Target {
  std::vector<Vector3d> directions;  // by segment, unit, world with y up
  Vector3d hips = Vector3d::Zero();  // mid-point of the hip joints, clip units
};

class Retargeter {
 public:
  // `axes`: see rest_axes(). `up`: of the clip's world.
  Retargeter(const BodyModel& body, const Clip& clip, const Parts& parts, const Matrix3d& axes, const Vector3d& up)
      : body_(body), skeleton_(body.skeleton), parts_(parts) {
    const std::vector<Rigid3> rest = rest_pose(clip);
    for (size_t s = 0; s < 2; ++s) {
      const std::string side = kSides[s];
      const Parts::Limbs& from = parts.side[s];
      add_limb(side + "thigh", side + "shin", from.thigh, from.shin);
      add_limb(side + "shin", side + "foot", from.shin, from.foot);
      add_limb(side + "upper_arm", side + "forearm", from.upper_arm, from.forearm);
      add_limb(side + "forearm", side + "hand", from.forearm, from.hand);
      if (from.toe >= 0 && distance(rest, from.foot, from.toe) > 0) {
        const double pitch = flat_foot_pitch(clip, from.foot, from.toe, axes.col(1), up);
        add_tip(side + "foot", {0, std::sin(pitch), std::cos(pitch)}, from.foot, from.toe);
      }
      if (from.finger >= 0 && distance(rest, from.hand, from.finger) > 0) {
        add_tip(side + "hand", -Vector3d::UnitY(), from.hand, from.finger);
      }
    }
    for (const auto& [name, source] : {std::pair{"root", parts.root}, {"thorax", parts.chest}, {"head", parts.head}}) {
      for (const int axis : {0, 1}) {
        Segment segment{.from_idx = joint(name),
                        .to_idx = joint(name),
                        .to_offset = Vector3d::Unit(axis),
                        .weight = kTrunkWeight,
                        .source_from = source,
                        .source_axis = axes.col(axis)};
        segments_.push_back(segment);
      }
    }
  }

  [[nodiscard]] const std::vector<Segment>& segments() const { return segments_; }

  // What the clip's joints [J] show. `y_up_from_clip` turns the clip's world.
  [[nodiscard]] Target target(std::span<const Rigid3> source, const Matrix3d& y_up_from_clip) const {
    Target out;
    out.hips = y_up_from_clip * middle(source, parts_.side[0].thigh, parts_.side[1].thigh);
    for (const Segment& segment : segments_) {
      const Rigid3& from = source[static_cast<size_t>(segment.source_from)];
      const Vector3d direction =
          segment.source_axis ? Vector3d(from.rotation * *segment.source_axis)
                              : Vector3d(source[static_cast<size_t>(segment.source_to)].translation - from.translation);
      out.directions.push_back((y_up_from_clip * direction).normalized());
    }
    return out;
  }

  // Turns `pose` [D] so that its segments point as the target's; the pose given is where the search starts, and where
  // what the target does not show stays. Returns what is left: the weighted sum of squares.
  double solve(const Target& target, std::vector<double>& pose) const {
    const auto num_dofs = static_cast<Eigen::Index>(pose.size());
    const std::vector<double> last = pose;
    System system = linearise(target, pose, last);
    double damping = 1e-3;
    for (int iteration = 0; iteration < kIterations && damping < 1e6; ++iteration) {
      Eigen::MatrixXd normal = system.normal;
      Eigen::VectorXd gradient = system.gradient;
      normal.diagonal().array() += damping;
      for (Eigen::Index d = 0; d < num_dofs; ++d) {
        if (!is_held(d, pose[static_cast<size_t>(d)], gradient[d])) continue;
        normal.row(d).setZero();
        normal.col(d).setZero();
        normal(d, d) = 1;
        gradient[d] = 0;
      }
      const Eigen::VectorXd step = -normal.ldlt().solve(gradient);
      std::vector<double> trial = pose;
      for (Eigen::Index d = 0; d < num_dofs; ++d) trial[static_cast<size_t>(d)] += step[d];
      skeleton_.clamp(trial);
      System next = linearise(target, trial, last);
      if (next.cost < system.cost) {
        const bool done = system.cost - next.cost < 1e-9 + 1e-6 * system.cost;
        pose = std::move(trial);
        system = std::move(next);
        damping = std::max(damping / 10, 1e-9);
        if (done) break;
      } else {
        damping *= 10;
      }
    }
    return system.cost;
  }

  // Angles in radians between the target and the pose, limbs only.
  [[nodiscard]] std::vector<double> limb_residuals(const Target& target, std::span<const double> pose) const {
    const std::vector<Rigid3> joints = skeleton_.forward_kinematics(pose);
    std::vector<double> angles;
    for (size_t s = 0; s < segments_.size(); ++s) {
      if (!segments_[s].is_limb) continue;
      const Vector3d ours = (end(segments_[s], joints) - start(segments_[s], joints)).normalized();
      angles.push_back(std::atan2(ours.cross(target.directions[s]).norm(), ours.dot(target.directions[s])));
    }
    return angles;
  }

  // Our leg length, both sides added. Metres.
  [[nodiscard]] double leg_length() const {
    const std::vector<double> zero(static_cast<size_t>(skeleton_.num_dofs()), 0.0);
    const std::vector<Rigid3> joints = skeleton_.forward_kinematics(zero);
    double length = 0;
    for (const std::string side : kSides) {
      length += distance(joints, joint(side + "thigh"), joint(side + "shin")) +
                distance(joints, joint(side + "shin"), joint(side + "foot"));
    }
    return length;
  }

  // Moves the root so that the mid-point of the hip joints lies at `hips`, world, metres.
  void place(const Vector3d& hips, std::vector<double>& pose) const {
    const std::vector<Rigid3> joints = skeleton_.forward_kinematics(pose);
    const Vector3d move = hips - middle(joints, joint("left_thigh"), joint("right_thigh"));
    for (size_t axis = 0; axis < 3; ++axis) pose[translation(axis)] += move[static_cast<Eigen::Index>(axis)];
  }

  [[nodiscard]] size_t translation(size_t axis) const {
    constexpr std::array kNames{"root_tx", "root_ty", "root_tz"};
    return static_cast<size_t>(skeleton_.find_dof(kNames[axis]).value());
  }

  // The body's lowest point. Metres.
  [[nodiscard]] double lowest(std::span<const double> pose) const {
    double y = std::numeric_limits<double>::infinity();
    for (const Eigen::Vector3f& x : skin_vertices(body_, pose)) y = std::min(y, static_cast<double>(x.y()));
    for (const Vector3d& x : landmark_positions(body_, pose)) y = std::min(y, x.y());
    return y;
  }

 private:
  struct System {
    Eigen::MatrixXd normal;
    Eigen::VectorXd gradient;
    double cost = 0;
  };

  [[nodiscard]] int joint(std::string_view name) const {
    const std::optional<int> found = skeleton_.find_joint(name);
    check(found.has_value(), "retarget: skeleton {} has no joint {}", skeleton_.name(), name);
    return *found;
  }

  void add_limb(const std::string& from, const std::string& to, int source_from, int source_to) {
    segments_.push_back({.from_idx = joint(from),
                         .to_idx = joint(to),
                         .weight = kLimbWeight,
                         .is_limb = true,
                         .source_from = source_from,
                         .source_to = source_to,
                         .source_axis = {}});
  }

  void add_tip(const std::string& of, const Vector3d& offset, int source_from, int source_to) {
    segments_.push_back({.from_idx = joint(of),
                         .to_idx = joint(of),
                         .to_offset = offset,
                         .weight = kTipWeight,
                         .source_from = source_from,
                         .source_to = source_to,
                         .source_axis = {}});
  }

  static Vector3d start(const Segment& s, std::span<const Rigid3> joints) {
    return joints[static_cast<size_t>(s.from_idx)] * s.from_offset;
  }
  static Vector3d end(const Segment& s, std::span<const Rigid3> joints) {
    return joints[static_cast<size_t>(s.to_idx)] * s.to_offset;
  }

  // At a limit and pulled beyond it, or not this solve's business.
  [[nodiscard]] bool is_held(Eigen::Index d, double value, double gradient) const {
    const Dof& dof = skeleton_.dofs()[static_cast<size_t>(d)];
    if (dof.is_translation) return true;
    if (dof.is_periodic) return false;
    return (value <= dof.lower && gradient > 0) || (value >= dof.upper && gradient < 0);
  }

  [[nodiscard]] System linearise(const Target& target, std::span<const double> pose,
                                 std::span<const double> last) const {
    const auto num_dofs = static_cast<Eigen::Index>(pose.size());
    const PointMotion motion(skeleton_, pose);
    const std::span<const Rigid3> joints = motion.world_from_joint();
    System system{Eigen::MatrixXd::Zero(num_dofs, num_dofs), Eigen::VectorXd::Zero(num_dofs), 0};
    for (size_t s = 0; s < segments_.size(); ++s) {
      const Segment& segment = segments_[s];
      const Vector3d x0 = start(segment, joints), x1 = end(segment, joints);
      const double length = (x1 - x0).norm();
      const Vector3d direction = (x1 - x0) / length;
      const Vector3d residual = direction - target.directions[s];
      const Eigen::Matrix3Xd jacobian = (Matrix3d::Identity() - direction * direction.transpose()) / length *
                                        (motion.jacobian(segment.to_idx, x1) - motion.jacobian(segment.from_idx, x0));
      system.normal.noalias() += segment.weight * jacobian.transpose() * jacobian;
      system.gradient.noalias() += segment.weight * jacobian.transpose() * residual;
      system.cost += segment.weight * residual.squaredNorm();
    }
    for (Eigen::Index d = 0; d < num_dofs; ++d) {
      const Dof& dof = skeleton_.dofs()[static_cast<size_t>(d)];
      if (dof.is_translation) continue;
      const double value = pose[static_cast<size_t>(d)];
      const double moved =
          dof.is_periodic ? wrap_angle(value - last[static_cast<size_t>(d)]) : value - last[static_cast<size_t>(d)];
      const double to_zero = dof.is_periodic ? 0 : kPullToZero;
      system.normal(d, d) += to_zero + kPullToLast;
      system.gradient[d] += to_zero * value + kPullToLast * moved;
      system.cost += to_zero * value * value + kPullToLast * moved * moved;
    }
    return system;
  }

  const BodyModel& body_;
  const Skeleton& skeleton_;
  Parts parts_;
  std::vector<Segment> segments_;
};

// Mean angle by which the limbs turn from one target to another.
double mean_turn(const std::vector<Segment>& segments, const Target& a, const Target& b) {
  double sum = 0;
  int count = 0;
  for (size_t s = 0; s < segments.size(); ++s) {
    if (!segments[s].is_limb) continue;
    sum += std::acos(std::clamp(a.directions[s].dot(b.directions[s]), -1.0, 1.0));
    ++count;
  }
  return sum / count;
}

Target interpolate(const Target& a, const Target& b, double fraction) {
  Target out;
  out.hips = a.hips + fraction * (b.hips - a.hips);
  for (size_t s = 0; s < a.directions.size(); ++s) {
    out.directions.push_back((a.directions[s] + fraction * (b.directions[s] - a.directions[s])).normalized());
  }
  return out;
}

// Where a limb's search starts again when it is stuck: joint, degrees about x and z; each with three twists.
struct Start {
  double rx_deg, rz_deg;
};
constexpr std::array<Start, 5> kArmStarts{{{0, 0}, {90, 0}, {0, 90}, {170, 0}, {45, 60}}};
constexpr std::array<Start, 3> kLegStarts{{{0, 0}, {90, 0}, {60, 35}}};

// Rotations in order have false minima: an arm may be held at a limit that it should leave the other way round. Limbs
// left far from the target are tried again from other poses.
void solve_stuck_limbs(const Retargeter& retargeter, const Skeleton& skeleton, const Target& target,
                       std::vector<double>& pose) {
  struct Limb {
    std::string upper, lower;
    std::span<const Start> starts;
    double twist_deg;
  };
  for (size_t limb_idx = 0; limb_idx < 4; ++limb_idx) {
    const std::vector<double> residuals = retargeter.limb_residuals(target, pose);  // thigh shin upper arm forearm
    if (std::max(residuals[2 * limb_idx], residuals[2 * limb_idx + 1]) < kStuck) continue;
    const std::string side = kSides[limb_idx / 2];
    const Limb limb = limb_idx % 2 == 0 ? Limb{side + "thigh", side + "shin", kLegStarts, 30}
                                        : Limb{side + "upper_arm", side + "forearm", kArmStarts, 60};
    const auto set = [&](std::vector<double>& to, const std::string& dof, double degrees) {
      if (const std::optional<int> d = skeleton.find_dof(dof)) to[static_cast<size_t>(*d)] = to_radians(degrees);
    };
    std::vector<double> best = pose;
    double best_cost = 0.8 * retargeter.solve(target, best) - 1e-3;  // of no use unless clearly better
    for (const Start& start : limb.starts) {
      for (const double twist : {-limb.twist_deg, 0.0, limb.twist_deg}) {
        std::vector<double> trial = pose;
        set(trial, limb.upper + "_rx", start.rx_deg);
        set(trial, limb.upper + "_ry", twist);
        set(trial, limb.upper + "_rz", start.rz_deg);
        set(trial, limb.lower + "_rx", 60);
        set(trial, limb.lower + "_ry", 0);
        const double cost = retargeter.solve(target, trial);
        if (cost < best_cost) best_cost = cost, best = trial;
      }
    }
    pose = best;
  }
}

// The first frame has no frame before it: start from standing poses that face each of eight directions.
std::vector<double> solve_first(const Retargeter& retargeter, const Skeleton& skeleton, const Target& target) {
  std::vector<double> best;
  double best_cost = std::numeric_limits<double>::infinity();
  const std::optional<int> heading = skeleton.find_dof("root_ry");
  check(heading.has_value(), "retarget: skeleton {} has no root_ry", skeleton.name());
  for (int turn = 0; turn < 8; ++turn) {
    std::vector<double> pose(static_cast<size_t>(skeleton.num_dofs()), 0.0);
    pose[static_cast<size_t>(*heading)] = wrap_angle(turn * kPi / 4);
    skeleton.clamp(pose);
    const double cost = retargeter.solve(target, pose);
    if (cost < best_cost) best_cost = cost, best = pose;
  }
  return best;
}

// Moves all poses so that the lowest points [T] of all but one in twenty are above the floor. `height`: the DOF that
// does.
void stand_on_floor(std::vector<double> lowest, size_t height, std::vector<std::vector<double>>& poses) {
  std::sort(lowest.begin(), lowest.end());
  const double floor = lowest[(lowest.size() - 1) / 20];
  for (std::vector<double>& pose : poses) pose[height] -= floor;
}

}  // namespace

Result<Retargeted> retarget(const Clip& clip, const BodyModel& body, const RetargetOptions& options) {
  check(options.fps > 0, "retarget: fps {} is not positive", options.fps);
  if (clip.num_frames() == 0) return error("{}: no frame", clip.name);
  const Result<Parts> parts = find_parts(clip);
  if (!parts) return parts.failure();

  const std::vector<Rigid3> rest = rest_pose(clip);
  double source_leg = 0;
  for (const Parts::Limbs& limbs : parts->side) {
    source_leg += distance(rest, limbs.thigh, limbs.shin) + distance(rest, limbs.shin, limbs.foot);
  }
  const Matrix3d axes = rest_axes(rest, *parts);
  if (source_leg <= 0 || !axes.allFinite() || axes.determinant() < 0.5) {
    return error("{}: its rest pose has no legs or no hips", clip.name);
  }
  Retargeted out;
  out.fps = options.fps;
  out.is_z_up = is_z_up(clip, *parts, axes.col(1));
  Matrix3d y_up_from_clip = Matrix3d::Identity();
  if (out.is_z_up) y_up_from_clip << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  const Retargeter retargeter(body, clip, *parts, axes, y_up_from_clip.row(1).transpose());
  out.metres_per_unit = retargeter.leg_length() / source_leg;
  const auto target_at = [&](size_t frame) { return retargeter.target(clip.world_from_joint(frame), y_up_from_clip); };

  out.first_frame_skipped =
      opens_at_rest(clip) && mean_turn(retargeter.segments(), target_at(0), target_at(1)) > kRestJump;

  const double num_samples = static_cast<double>(clip.num_frames()) / clip.fps * options.fps;
  if (num_samples > kMostFrames) {
    return error("{}: is {:.0f} frames at {} per second", clip.name, num_samples, options.fps);
  }
  std::vector<double> pose, lowest;
  double sum = 0, count = 0;
  for (const double time : sample_times(clip, out.first_frame_skipped ? 1 : 0, options.fps)) {
    const auto before = static_cast<size_t>(time);
    const double fraction = time - static_cast<double>(before);
    Target target = target_at(before);
    if (fraction > 0) target = interpolate(target, target_at(before + 1), fraction);
    if (pose.empty()) {
      pose = solve_first(retargeter, body.skeleton, target);
    } else {
      retargeter.solve(target, pose);
    }
    solve_stuck_limbs(retargeter, body.skeleton, target, pose);
    retargeter.place(target.hips * out.metres_per_unit, pose);
    for (const double angle : retargeter.limb_residuals(target, pose)) {
      sum += angle;
      ++count;
      out.max_residual_deg = std::max(out.max_residual_deg, to_degrees(angle));
    }
    lowest.push_back(retargeter.lowest(pose));
    out.poses.push_back(pose);
  }
  out.mean_residual_deg = to_degrees(sum / count);

  stand_on_floor(std::move(lowest), retargeter.translation(1), out.poses);
  return out;
}

}  // namespace silpose
