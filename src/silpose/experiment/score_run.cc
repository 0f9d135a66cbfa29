#include "silpose/experiment/score_run.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "silpose/base/check.h"
#include "silpose/base/parallel.h"
#include "silpose/evaluate/evaluation.h"
#include "silpose/evaluate/interval_coverage.h"
#include "silpose/experiment/score_parts.h"
#include "silpose/render/silhouette.h"
#include "silpose/synth/sequence_files.h"

namespace silpose {
namespace {

double time_of(const SyntheticSequence& truth, int64_t frame) { return static_cast<double>(frame) / truth.fps; }

// The same joints without the hips: those of the thesis' 2D error.
JointTable without_hips(const JointTable& joints) {
  JointTable rest;
  for (const JointTable::Row& row : joints.rows) {
    if (row.joint != "right_thigh" && row.joint != "left_thigh") rest.rows.push_back(row);
  }
  return rest;
}

size_t index_of(const std::vector<std::string>& names, const std::string& name) {
  return static_cast<size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

// IoU with the true silhouette per frame; NaN without a pose. [R]
std::vector<double> overlaps(const SyntheticSequence& truth, const BodyModel& body,
                             std::span<const StepReport> reports) {
  std::vector<double> overlap(reports.size(), kAbsent);
  parallel_for(reports.size(), 1, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      if (reports[i].pose.empty()) continue;
      const Mask seen = render_silhouette(body, truth.cameras[0], reports[i].pose);
      overlap[i] = intersection_over_union(seen, true_mask(truth, 0, static_cast<int>(reports[i].frame_idx)));
    }
  });
  return overlap;
}

// How often the truth lies inside the claimed intervals.
void add_coverage(const SyntheticSequence& truth, const BodyModel& body, std::span<const StepReport> reports,
                  RunResult& run) {
  std::vector<const StepReport*> claimed;
  for (const StepReport& report : reports) {
    if (!report.pose.empty() && !report.spread.empty() && !report.landmark_spread.empty()) claimed.push_back(&report);
  }
  if (claimed.empty()) return;
  const auto num_dofs = static_cast<Eigen::Index>(body.skeleton.num_dofs());
  const std::vector<std::string> names = landmark_names(body);
  const auto num_coordinates = static_cast<Eigen::Index>(3 * names.size());
  const auto num_frames = static_cast<Eigen::Index>(claimed.size());
  Eigen::MatrixXd dof_errors(num_frames, num_dofs), dof_spreads(num_frames, num_dofs);
  Eigen::MatrixXd joint_errors(num_frames, num_coordinates), joint_spreads(num_frames, num_coordinates);
  for (Eigen::Index t = 0; t < num_frames; ++t) {
    const StepReport& report = *claimed[static_cast<size_t>(t)];
    const auto true_pose = pose_of_frame(truth, static_cast<int>(report.frame_idx));
    const std::vector<double> difference = pose_difference(body.skeleton, report.pose, true_pose);
    for (Eigen::Index d = 0; d < num_dofs; ++d) {
      dof_errors(t, d) = difference[static_cast<size_t>(d)];
      dof_spreads(t, d) = report.spread[static_cast<size_t>(d)];
    }
    const auto positions = landmark_positions(body, report.pose),
               true_positions = landmark_positions(*truth.body, true_pose);
    for (size_t i = 0; i < names.size(); ++i) {
      const auto column = static_cast<Eigen::Index>(3 * i);
      joint_errors.block<1, 3>(t, column) = (positions[i] - true_positions[i]).transpose();
      joint_spreads.block<1, 3>(t, column) = report.landmark_spread[i].transpose();
    }
  }
  const std::vector<double> dofs = interval_coverage(dof_errors, dof_spreads);
  const std::vector<double> joints = interval_coverage(joint_errors, joint_spreads);
  for (size_t d = 0; d < dofs.size(); ++d) run.scores["interval_dof/" + body.skeleton.dofs()[d].name] = dofs[d];
  for (size_t k = 0; k < joints.size(); ++k) {
    run.scores[fmt::format("interval_joint/{}_{}", names[k / 3], "xyz"[k % 3])] = joints[k];
  }
  run.scores["coverage_dof"] = mean_of(dofs);
  run.scores["coverage_joint"] = mean_of(joints);
}

}  // namespace

Result<RunResult> score_run(const SyntheticSequence& truth, const BodyModel& tracker_body,
                            std::span<const StepReport> reports) {
  check(!reports.empty(), "score_run: no reports");
  check(tracker_body.skeleton.num_dofs() == truth.body->skeleton.num_dofs() &&
            landmark_names(tracker_body) == landmark_names(*truth.body),
        "score_run: the tracker's body has another skeleton than the true one");
  for (const StepReport& report : reports) {
    check(report.frame_idx >= truth.lead_in && report.frame_idx < truth.num_frames(), "score_run: frame {} of {}",
          report.frame_idx, truth.num_frames());
  }
  const Recorded result = recorded_of(tracker_body, truth.cameras[0], reports,
                                      [&](const StepReport& report) { return time_of(truth, report.frame_idx); });
  Recorded recorded_truth, without;
  recorded_truth.poses = true_poses(truth, truth.num_frames());
  recorded_truth.joints = true_joints(truth, truth.num_frames());
  without.joints = without_hips(*recorded_truth.joints);
  const auto frames = evaluate_frames(result, recorded_truth, tracker_body);
  const auto thesis_frames = evaluate_frames(result, without, tracker_body);
  if (!frames) return frames.failure();
  if (!thesis_frames) return thesis_frames.failure();

  RunResult run;
  const std::vector<std::string> all_figures = figure_names();
  std::vector<size_t> kept;  // those that need no masks on disk
  run.frame_columns = {"frame", "time_s"};
  for (size_t k = 0; k < all_figures.size(); ++k) {
    if (all_figures[k] == "visual_accuracy" || all_figures[k] == "mask_iou") continue;
    kept.push_back(k);
    run.frame_columns.push_back(all_figures[k]);
  }
  run.frame_columns.insert(run.frame_columns.end(), {"error_2d_px", "iou"});
  const size_t px = index_of(all_figures, "joint_error_px");
  const std::vector<double> overlap = overlaps(truth, tracker_body, reports);

  size_t next = 0;  // in frames, which lack those without a pose
  for (size_t i = 0; i < reports.size(); ++i) {
    std::vector<double> row = {static_cast<double>(reports[i].frame_idx), time_of(truth, reports[i].frame_idx)};
    const bool has_pose = next < frames->size() && (*frames)[next].frame == reports[i].frame_idx;
    for (const size_t k : kept) row.push_back(has_pose ? (*frames)[next].values[k].value_or(kAbsent) : kAbsent);
    row.push_back(has_pose ? (*thesis_frames)[next].values[px].value_or(kAbsent) : kAbsent);
    row.push_back(overlap[i]);
    next += has_pose ? 1 : 0;
    run.frames.push_back(std::move(row));
  }
  for (size_t column = 2; column < run.frame_columns.size(); ++column) {
    add_mean_and_deviation(run.frame_columns[column], run.frames, column, run);
  }
  run.scores["frames"] = static_cast<double>(reports.size());
  run.scores["frames_missing"] = static_cast<double>(reports.size() - frames->size());
  const size_t root = index_of(run.frame_columns, "joint_error_root_mm");
  std::vector<double> root_errors;
  for (const std::vector<double>& row : run.frames) root_errors.push_back(row[root]);
  add_verdicts(root_errors, run);
  add_coverage(truth, tracker_body, reports, run);
  return run;
}

}  // namespace silpose
