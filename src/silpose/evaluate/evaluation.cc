#include "silpose/evaluate/evaluation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>

#include "silpose/base/check.h"
#include "silpose/base/parallel.h"
#include "silpose/evaluate/pose_error.h"
#include "silpose/image/image_file.h"
#include "silpose/render/silhouette.h"

namespace silpose {
namespace {

constexpr double kTimeSlack = 1e-6;  // times are written with six decimals

// The figures in the order in which they are reported.
enum FigureIndex {
  kPoseNpsu,
  kPoseDeg,
  kAngleDeg,
  kJointMm,
  kJointRootMm,
  kJointAlignedMm,
  kJointPx,
  kVisualAccuracy,
  kMaskIou,
  kNumFigures
};
constexpr std::array<const char*, kNumFigures> kFigureNames = {
    "pose_error_npsu",        "pose_error_deg", "angle_error_deg", "joint_error_mm", "joint_error_root_mm",
    "joint_error_aligned_mm", "joint_error_px", "visual_accuracy", "mask_iou"};

using FrameFigures = std::array<std::optional<double>, kNumFigures>;
using JointsOfFrame = std::vector<const JointTable::Row*>;  // [landmarks of the profile]; null where it is not there

// One side by frame number.
struct Side {
  Side(const Recorded& recorded, const RigProfile& profile) {
    if (recorded.poses) {
      for (const PoseTable::Row& row : recorded.poses->rows) {
        poses.emplace(row.frame, &row);
        times.emplace(row.frame, row.time_s);
      }
    }
    if (!recorded.joints) return;
    for (const JointTable::Row& row : recorded.joints->rows) {
      times.emplace(row.frame, row.time_s);
      JointsOfFrame& frame = joints.try_emplace(row.frame, JointsOfFrame(profile.landmarks.size())).first->second;
      for (size_t k = 0; k < frame.size(); ++k) {
        if (row.joint == profile.landmarks[k].name) frame[k] = &row;
      }
    }
  }

  std::map<int64_t, const PoseTable::Row*> poses;
  std::map<int64_t, JointsOfFrame> joints;
  std::map<int64_t, double> times;  // of every frame with a pose or joints
};

// Images of two cameras are not compared. A side without a camera, or with one that has no name of its own, is taken
// to mean the other's.
bool see_the_same(const Recorded& result, const Recorded& truth) {
  if (result.cameras.empty() || truth.cameras.empty()) return true;
  const std::string nameless = PinholeCamera().name;
  const std::string &one = result.cameras[0].name, &other = truth.cameras[0].name;
  return one == other || one == nameless || other == nameless;
}

void add_pose_errors(const Skeleton& skeleton, std::span<const double> pose, std::span<const double> truth,
                     FrameFigures& figures) {
  figures[kPoseNpsu] = pose_error_npsu(skeleton, pose, truth);
  figures[kPoseDeg] = pose_error_deg(skeleton, pose, truth);
  figures[kAngleDeg] = angle_error_deg(skeleton, pose, truth);
}

// The mean of the landmarks that are the profile's origin; nothing where one is missing.
std::optional<Eigen::Vector3d> origin_of(const RigProfile& profile, const JointsOfFrame& joints) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const std::string& name : profile.origin) {
    const auto landmark = std::ranges::find(profile.landmarks, name, &RigProfile::Landmark::name);
    if (landmark == profile.landmarks.end()) return std::nullopt;
    const JointTable::Row* const row = joints[static_cast<size_t>(landmark - profile.landmarks.begin())];
    if (!row) return std::nullopt;
    sum += row->x_in_world;
  }
  if (profile.origin.empty()) return std::nullopt;
  return sum / static_cast<double>(profile.origin.size());
}

void add_joint_errors(const RigProfile& profile, const JointsOfFrame& result, const JointsOfFrame& truth,
                      FrameFigures& figures) {
  std::vector<size_t> shared, seen;  // joints that both have, and have in the image
  for (size_t k = 0; k < result.size(); ++k) {
    if (!result[k] || !truth[k]) continue;
    shared.push_back(k);
    if (result[k]->pixel.allFinite() && truth[k]->pixel.allFinite()) seen.push_back(k);
  }
  if (shared.empty()) return;
  constexpr double kMmPerMetre = 1000;
  const auto count = static_cast<Eigen::Index>(shared.size());
  Eigen::Matrix3Xd points(3, count), true_points(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    points.col(i) = result[shared[static_cast<size_t>(i)]]->x_in_world;
    true_points.col(i) = truth[shared[static_cast<size_t>(i)]]->x_in_world;
  }
  figures[kJointMm] = kMmPerMetre * mean_distance(points, true_points);
  if (const auto aligned = aligned_distance(points, true_points)) figures[kJointAlignedMm] = kMmPerMetre * *aligned;
  const auto origin = origin_of(profile, result), true_origin = origin_of(profile, truth);
  if (origin && true_origin) {
    figures[kJointRootMm] =
        kMmPerMetre * mean_distance(points.colwise() - *origin, true_points.colwise() - *true_origin);
  }
  if (!seen.empty()) {
    double sum = 0;
    for (const size_t k : seen) sum += (result[k]->pixel - truth[k]->pixel).norm();
    figures[kJointPx] = sum / static_cast<double>(seen.size());
  }
}

// Compares masks of one frame: the rendered pose's and the result's with the truth's.
Result<void> add_mask_figures(const Recorded& result, const Recorded& truth, const BodyModel& body, int64_t frame,
                              const PoseTable::Row* pose, FrameFigures& figures) {
  const auto truth_file = truth.mask_files.find(frame), result_file = result.mask_files.find(frame);
  if (truth_file == truth.mask_files.end()) return {};
  const auto& cameras = truth.cameras.empty() ? result.cameras : truth.cameras;
  const bool can_render = pose && !cameras.empty();
  if (!can_render && result_file == result.mask_files.end()) return {};
  const auto true_mask = read_mask(truth_file->second);
  if (!true_mask) return true_mask.failure();
  if (can_render) {
    const PinholeCamera& camera = cameras[0];
    if (camera.width != true_mask->width() || camera.height != true_mask->height()) {
      return error("{}: {} x {} pixels, but camera '{}' has {} x {}", truth_file->second.string(), true_mask->width(),
                   true_mask->height(), camera.name, camera.width, camera.height);
    }
    figures[kVisualAccuracy] = intersection_over_union(render_silhouette(body, camera, pose->values), *true_mask);
  }
  if (result_file != result.mask_files.end() && see_the_same(result, truth)) {
    const auto mask = read_mask(result_file->second);
    if (!mask) return mask.failure();
    if (mask->width() != true_mask->width() || mask->height() != true_mask->height()) {
      return error("{}: {} x {} pixels, but {} has {} x {}", result_file->second.string(), mask->width(),
                   mask->height(), truth_file->second.string(), true_mask->width(), true_mask->height());
    }
    figures[kMaskIou] = intersection_over_union(*mask, *true_mask);
  }
  return {};
}

// The truth's frames that count, ascending: those with a pose or joints, or masks where it has neither. Times of a
// truth of masks alone are the result's.
std::vector<int64_t> true_frames(const Recorded& truth, const Side& truth_side, const Side& result_side,
                                 const EvaluateOptions& options) {
  std::vector<int64_t> frames;
  const auto add = [&](int64_t frame, const std::map<int64_t, double>& times) {
    const auto time = times.find(frame);
    const bool inside = time == times.end() ||
                        (time->second >= options.start_s - kTimeSlack && time->second < options.end_s - kTimeSlack);
    if (inside) frames.push_back(frame);
  };
  for (const auto& [frame, time] : truth_side.times) add(frame, truth_side.times);
  if (truth_side.times.empty()) {
    for (const auto& [frame, file] : truth.mask_files) add(frame, result_side.times);
  }
  return frames;
}

// Both sides by frame number, and the frames that both have.
struct Sides {
  Sides(const Recorded& result_recorded, const Recorded& truth_recorded, const RigProfile& profile,
        const EvaluateOptions& options)
      : result(result_recorded, profile), truth(truth_recorded, profile) {
    check(options.start_s < options.end_s, "evaluate from {} to {} s", options.start_s, options.end_s);
    for (const int64_t frame : true_frames(truth_recorded, truth, result, options)) {
      const bool is_there = result.times.contains(frame) || result_recorded.mask_files.contains(frame);
      if (is_there) frames.push_back(frame);
      frames_missing += is_there ? 0 : 1;
    }
  }

  Side result, truth;
  std::vector<int64_t> frames;  // ascending
  int64_t frames_missing = 0;
};

// [sides.frames]
Result<std::vector<FrameFigures>> frame_figures(const Recorded& result, const Recorded& truth, const BodyModel& body,
                                                const Sides& sides) {
  std::vector<FrameFigures> figures(sides.frames.size());
  std::vector<Result<void>> outcomes(sides.frames.size());
  parallel_for(sides.frames.size(), 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const int64_t frame = sides.frames[i];
      const auto pose = sides.result.poses.find(frame), true_pose = sides.truth.poses.find(frame);
      const bool has_pose = pose != sides.result.poses.end();
      if (has_pose && true_pose != sides.truth.poses.end()) {
        add_pose_errors(body.skeleton, pose->second->values, true_pose->second->values, figures[i]);
      }
      const auto joints = sides.result.joints.find(frame), true_joints = sides.truth.joints.find(frame);
      if (joints != sides.result.joints.end() && true_joints != sides.truth.joints.end()) {
        add_joint_errors(body.profile, joints->second, true_joints->second, figures[i]);
        if (!see_the_same(result, truth)) figures[i][kJointPx].reset();
      }
      outcomes[i] = add_mask_figures(result, truth, body, frame, has_pose ? pose->second : nullptr, figures[i]);
    }
  });
  for (const Result<void>& outcome : outcomes) {
    if (!outcome) return outcome.failure();
  }
  return figures;
}

std::optional<Figure> figure_over_frames(const std::vector<FrameFigures>& frames, size_t index) {
  double sum = 0, sum_of_squares = 0;
  int64_t count = 0;
  for (const FrameFigures& frame : frames) {
    if (frame[index]) sum += *frame[index], ++count;
  }
  if (count == 0) return std::nullopt;
  const double mean = sum / static_cast<double>(count);
  for (const FrameFigures& frame : frames) {
    if (frame[index]) sum_of_squares += (*frame[index] - mean) * (*frame[index] - mean);
  }
  return Figure{mean, std::sqrt(sum_of_squares / static_cast<double>(count))};
}

}  // namespace

std::optional<Figure> Evaluation::find(std::string_view name) const {
  for (const auto& [figure_name, figure] : figures) {
    if (figure_name == name) return figure;
  }
  return std::nullopt;
}

std::vector<std::string> figure_names() { return {kFigureNames.begin(), kFigureNames.end()}; }

Result<std::vector<FrameEvaluation>> evaluate_frames(const Recorded& result, const Recorded& truth,
                                                     const BodyModel& body, const EvaluateOptions& options) {
  const Sides sides(result, truth, body.profile, options);
  const auto figures = frame_figures(result, truth, body, sides);
  if (!figures) return figures.failure();
  std::vector<FrameEvaluation> frames;
  frames.reserve(sides.frames.size());
  for (size_t i = 0; i < sides.frames.size(); ++i) {
    frames.push_back({sides.frames[i], {(*figures)[i].begin(), (*figures)[i].end()}});
  }
  return frames;
}

Result<Evaluation> evaluate(const Recorded& result, const Recorded& truth, const BodyModel& body,
                            const EvaluateOptions& options) {
  const Sides sides(result, truth, body.profile, options);
  const auto figures = frame_figures(result, truth, body, sides);
  if (!figures) return figures.failure();
  Evaluation evaluation;
  evaluation.frames = static_cast<int64_t>(sides.frames.size());
  evaluation.frames_missing = sides.frames_missing;
  for (size_t k = 0; k < kNumFigures; ++k) {
    evaluation.figures.emplace_back(kFigureNames[k], figure_over_frames(*figures, k));
  }
  return evaluation;
}

}  // namespace silpose
