#include "silpose/synth/motion_source.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>

#include "silpose/base/check.h"
#include "silpose/base/rng.h"
#include "silpose/exchange/clip_file.h"
#include "silpose/mocap/retarget.h"

namespace silpose {
namespace {

using Pose = std::vector<double>;
using Poses = std::vector<Pose>;

constexpr int kDefaultFrames = 80;
constexpr double kCircleRadius = 1.0, kGaitPeriod = 1.1;  // m, s for two steps

int count_frames(const SyntheticMotionOptions& options) {
  return options.num_frames > 0 ? options.num_frames : kDefaultFrames;
}

bool is_human(const Skeleton& skeleton) { return skeleton.find_dof("left_thigh_rx") && skeleton.find_dof("root_ty"); }

// Sets a DOF where the skeleton has it; radians or metres.
void set(const Skeleton& skeleton, Pose& pose, const std::string& dof, double value) {
  if (const auto d = skeleton.find_dof(dof)) pose[static_cast<size_t>(*d)] = value;
}

void set_both(const Skeleton& skeleton, Pose& pose, const std::string& dof, double value) {
  for (const char* side : {"left_", "right_"}) set(skeleton, pose, side + dof, value);
}

Pose zero_pose(const Skeleton& skeleton) { return Pose(static_cast<size_t>(skeleton.num_dofs()), 0.0); }

// Moves a pose so that its lowest point is at y = 0. A body that cannot rise stays where it is.
void stand(const BodyModel& body, Pose& pose, double lowest) {
  if (const auto d = body.skeleton.find_dof("root_ty")) pose[static_cast<size_t>(*d)] -= lowest;
}

void stand(const BodyModel& body, Pose& pose) { stand(body, pose, lowest_point(body, pose)); }

// The whole motion is moved by one offset: its lowest frame touches the floor.
void stand(const BodyModel& body, Poses& poses) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Pose& pose : poses) lowest = std::min(lowest, lowest_point(body, pose));
  for (Pose& pose : poses) stand(body, pose, lowest);
}

bool is_root_dof(const Skeleton& skeleton, const Dof& dof) {
  return skeleton.joints()[static_cast<size_t>(dof.joint_idx)].parent_idx < 0;
}

// Limbs outside the trunk and apart from each other; upright enough to be seen as standing or crouching.
bool is_plausible(const BodyModel& body, const Pose& pose) {
  const Skeleton& skeleton = body.skeleton;
  if (!is_human(skeleton)) return true;
  const std::vector<Rigid3> joints = skeleton.forward_kinematics(pose);
  const auto at = [&](const std::string& name) {
    return joints[static_cast<size_t>(skeleton.find_joint(name).value())].translation;
  };
  const double leg = (at("left_thigh") - at("left_shin")).norm() + (at("left_shin") - at("left_foot")).norm();
  const auto from_segment = [](const Eigen::Vector3d& x, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    const double along = std::clamp((x - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
    return (x - a - along * (b - a)).norm();
  };
  const Eigen::Vector3d pelvis = at("root"), neck = at("head");
  for (const std::string side : {"left_", "right_"}) {
    for (const char* joint : {"forearm", "hand"}) {
      if (from_segment(at(side + joint), pelvis, neck) < 0.2 * leg) return false;
    }
    for (const std::string other : {"left_", "right_"}) {
      if (from_segment(at(side + "hand"), at(other + "thigh"), at(other + "shin")) < 0.15 * leg) return false;
    }
  }
  if (from_segment(at("left_hand"), at("right_forearm"), at("right_hand")) < 0.15 * leg) return false;
  if (from_segment(at("left_shin"), at("right_thigh"), at("right_shin")) < 0.15 * leg) return false;
  if (from_segment(at("left_foot"), at("right_shin"), at("right_foot")) < 0.15 * leg) return false;
  if (from_segment(at("right_foot"), at("left_shin"), at("left_foot")) < 0.15 * leg) return false;
  const double lowest_foot = std::min(at("left_foot").y(), at("right_foot").y());
  return pelvis.y() - lowest_foot > 0.6 * leg;
}

}  // namespace

double lowest_point(const BodyModel& body, const Pose& pose) {
  double lowest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3f& x : skin_vertices(body, pose)) lowest = std::min(lowest, static_cast<double>(x.y()));
  return std::isfinite(lowest) ? lowest : 0;
}

Pose draw_static_pose(const BodyModel& body, uint64_t seed) {
  constexpr double kShare = 0.6;   // of the way to a limit
  constexpr int kAttempts = 2000;  // about one in ten draws is plausible
  const Skeleton& skeleton = body.skeleton;
  Pose pose;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    Rng rng(seed, static_cast<uint64_t>(attempt));
    pose = zero_pose(skeleton);
    for (int d = 0; d < skeleton.num_dofs(); ++d) {
      const Dof& dof = skeleton.dofs()[static_cast<size_t>(d)];
      const double u = rng.uniform(-0.5, 0.5) + rng.uniform(-0.5, 0.5);  // triangular in (-1, 1)
      if (dof.is_translation) continue;
      const bool is_tilt = is_root_dof(skeleton, dof) && std::abs(dof.axis.y()) < 0.5;
      const double reach = is_tilt           ? to_radians(10)
                           : dof.is_periodic ? to_radians(30)
                                             : kShare * (u < 0 ? -std::min(dof.lower, 0.0) : std::max(dof.upper, 0.0));
      pose[static_cast<size_t>(d)] = u * reach;
    }
    skeleton.clamp(pose);
    if (is_plausible(body, pose)) break;
  }
  stand(body, pose);
  return pose;
}

Poses sweep_dof(const BodyModel& body, int dof_idx, const SyntheticMotionOptions& options) {
  check(dof_idx >= 0 && dof_idx < body.skeleton.num_dofs(), "sweep_dof: index {} of {}", dof_idx,
        body.skeleton.num_dofs());
  const Dof& dof = body.skeleton.dofs()[static_cast<size_t>(dof_idx)];
  const int num_frames = count_frames(options);
  const double period = options.period_s.value_or(num_frames / options.fps);
  Pose standing = zero_pose(body.skeleton);
  stand(body, standing);
  Poses poses;
  for (int t = 0; t < num_frames; ++t) {
    const double phase = 2 * kPi * t / options.fps / period;
    Pose pose = standing;
    pose[static_cast<size_t>(dof_idx)] = dof.lower + (dof.upper - dof.lower) * (1 - std::cos(phase)) / 2;
    poses.push_back(std::move(pose));
  }
  return poses;
}

Poses sway(const BodyModel& body, const SyntheticMotionOptions& options) {
  const Skeleton& skeleton = body.skeleton;
  const double amplitude = to_radians(options.amplitude_deg.value_or(8)), period = options.period_s.value_or(4);
  const auto foot = skeleton.find_joint("left_foot"), other_foot = skeleton.find_joint("right_foot");
  Poses poses;
  for (int t = 0; t < count_frames(options); ++t) {
    const double phase = 2 * kPi * t / options.fps / period;
    Pose pose = zero_pose(skeleton);
    if (!is_human(skeleton)) {
      for (size_t d = 0; d < pose.size(); ++d) {
        const Dof& dof = skeleton.dofs()[d];
        if (!dof.is_translation) pose[d] = amplitude * std::sin(phase + static_cast<double>(d));
      }
    } else {
      const double lean = amplitude * std::sin(phase), nod = 0.4 * amplitude * std::sin(2 * phase);
      set(skeleton, pose, "root_rz", lean);
      set(skeleton, pose, "root_rx", nod);
      set(skeleton, pose, "thorax_rz", -0.6 * lean);
      set(skeleton, pose, "head_rz", -0.4 * lean);
      set_both(skeleton, pose, "upper_arm_rz", to_radians(12) + 0.8 * amplitude * (1 - std::cos(phase)));
      set(skeleton, pose, "left_upper_arm_rx", 2 * nod);
      set(skeleton, pose, "right_upper_arm_rx", -2 * nod);
      set_both(skeleton, pose, "forearm_rx", to_radians(15) + amplitude * (1 - std::cos(phase)) / 2);
      set_both(skeleton, pose, "foot_rx", nod);
    }
    skeleton.clamp(pose);
    if (foot && other_foot && is_human(skeleton)) {  // the ankles stay where they are
      const auto joints = skeleton.forward_kinematics(pose);
      const Eigen::Vector3d middle =
          (joints[static_cast<size_t>(*foot)].translation + joints[static_cast<size_t>(*other_foot)].translation) / 2;
      set(skeleton, pose, "root_tx", -middle.x());
      set(skeleton, pose, "root_tz", -middle.z());
    }
    stand(body, pose);
    poses.push_back(std::move(pose));
  }
  return poses;
}

Poses walk_circle(const BodyModel& body, const SyntheticMotionOptions& options) {
  const Skeleton& skeleton = body.skeleton;
  const double swing = to_radians(options.amplitude_deg.value_or(25)), lap = options.period_s.value_or(6);
  Poses poses;
  for (int t = 0; t < count_frames(options); ++t) {
    const double time = t / options.fps, angle = 2 * kPi * time / lap, gait = 2 * kPi * time / kGaitPeriod;
    Pose pose = zero_pose(skeleton);
    set(skeleton, pose, "root_tx", kCircleRadius * std::sin(angle));
    set(skeleton, pose, "root_tz", kCircleRadius * std::cos(angle));
    set(skeleton, pose, "root_ry", wrap_angle(angle + kPi / 2));
    for (const auto& [side, phase] : {std::pair<std::string, double>{"left_", gait}, {"right_", gait + kPi}}) {
      const double thigh = swing * std::sin(phase);
      set(skeleton, pose, side + "thigh_rx", thigh + 0.2 * swing);
      set(skeleton, pose, side + "shin_rx", to_radians(8) + swing * (1 + std::cos(phase)));  // bends while it swings
      set(skeleton, pose, side + "foot_rx", 0.3 * thigh);
      set(skeleton, pose, side + "upper_arm_rx", -0.8 * thigh);
      set(skeleton, pose, side + "upper_arm_rz", to_radians(10));
      set(skeleton, pose, side + "forearm_rx", to_radians(30) - 0.5 * thigh);
    }
    set(skeleton, pose, "thorax_ry", 0.2 * swing * std::sin(gait));
    skeleton.clamp(pose);
    stand(body, pose);
    poses.push_back(std::move(pose));
  }
  return poses;
}

Poses random_smooth(const BodyModel& body, const SyntheticMotionOptions& options) {
  constexpr int kTerms = 4;
  const Skeleton& skeleton = body.skeleton;
  const double amplitude = to_radians(options.amplitude_deg.value_or(25)), period = options.period_s.value_or(2);
  Pose centre = zero_pose(skeleton);
  set_both(skeleton, centre, "upper_arm_rz", to_radians(35));
  set_both(skeleton, centre, "forearm_rx", to_radians(40));
  set_both(skeleton, centre, "thigh_rz", to_radians(8));
  set_both(skeleton, centre, "thigh_rx", to_radians(10));
  set_both(skeleton, centre, "shin_rx", to_radians(25));

  Poses poses(static_cast<size_t>(count_frames(options)), centre);
  for (size_t d = 0; d < centre.size(); ++d) {
    const Dof& dof = skeleton.dofs()[d];
    Rng rng(options.seed, d);
    std::array<double, kTerms> frequency{}, phase{};
    for (int k = 0; k < kTerms; ++k) {
      frequency[static_cast<size_t>(k)] = rng.uniform(0.25, 1) / period;
      phase[static_cast<size_t>(k)] = rng.uniform(0, 2 * kPi);
    }
    if (dof.is_translation && std::abs(dof.axis.y()) > 0.5) continue;  // the floor determines it
    double reach = amplitude;
    if (dof.is_translation) reach = 0.3;
    if (!dof.is_translation && is_root_dof(skeleton, dof))
      reach = std::abs(dof.axis.y()) > 0.5 ? amplitude : 0.3 * amplitude;
    if (!dof.is_periodic) reach = std::min({reach, dof.upper - centre[d], centre[d] - dof.lower});
    reach = std::max(reach, 0.0);
    for (size_t t = 0; t < poses.size(); ++t) {
      double sum = 0;
      for (size_t k = 0; k < kTerms; ++k) {
        sum += std::sin(2 * kPi * frequency[k] * static_cast<double>(t) / options.fps + phase[k]);
      }
      poses[t][d] += reach * std::clamp(sum / std::sqrt(2.0 * kTerms), -1.0, 1.0);
    }
  }
  for (Pose& pose : poses) skeleton.clamp(pose);
  stand(body, poses);
  return poses;
}

Result<SyntheticMotion> motion_from_clip(const Clip& clip, const BodyModel& body,
                                         const SyntheticMotionOptions& options) {
  Result<Retargeted> retargeted = retarget(clip, body, {.fps = options.fps});
  if (!retargeted) return retargeted.failure();
  SyntheticMotion motion;
  motion.fps = options.fps;
  motion.poses = std::move(retargeted->poses);
  motion.mean_residual_deg = retargeted->mean_residual_deg;
  motion.max_residual_deg = retargeted->max_residual_deg;
  const auto wanted = static_cast<size_t>(std::max(options.num_frames, 0));
  if (wanted > motion.poses.size()) {
    return error("{}: {} frames at {} frames/s, not {}", clip.name, motion.poses.size(), options.fps, wanted);
  }
  if (wanted > 0) motion.poses.resize(wanted);
  return motion;
}

Result<SyntheticMotion> make_motion(const std::string& name, const BodyModel& body,
                                    const SyntheticMotionOptions& options) {
  check(options.fps > 0, "make_motion: fps {} is not positive", options.fps);
  check(options.num_frames >= 0, "make_motion: {} frames", options.num_frames);
  check(options.period_s.value_or(1) > 0, "make_motion: period {} s is not positive", options.period_s.value_or(1));
  if (is_clip_file(name)) {
    const Result<Clip> clip = read_clip(name);
    if (!clip) return clip.failure();
    return motion_from_clip(*clip, body, options);
  }
  SyntheticMotion motion;
  motion.fps = options.fps;
  if (name == "static") {
    motion.poses.assign(static_cast<size_t>(count_frames(options)), draw_static_pose(body, options.seed));
  } else if (name == "sway") {
    motion.poses = sway(body, options);
  } else if (name == "circle") {
    motion.poses = walk_circle(body, options);
  } else if (name == "random") {
    motion.poses = random_smooth(body, options);
  } else if (name.starts_with("dof:")) {
    int index = -1;
    const char* first = name.data() + 4;
    const char* last = name.data() + name.size();
    const auto parsed = std::from_chars(first, last, index);
    if (parsed.ec != std::errc() || parsed.ptr != last || index < 0 || index >= body.skeleton.num_dofs()) {
      return error("motion {}: the DOF is a number from 0 to {}", name, body.skeleton.num_dofs() - 1);
    }
    motion.poses = sweep_dof(body, index, options);
  } else {
    return error("unknown motion '{}': a .bvh or humanoid3d .txt file, static, dof:INDEX, circle, sway or random",
                 name);
  }
  return motion;
}

}  // namespace silpose
