#include "silpose/experiment/score_clip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "silpose/base/check.h"
#include "silpose/base/median.h"
#include "silpose/base/parallel.h"
#include "silpose/evaluate/interval_coverage.h"
#include "silpose/evaluate/pose_error.h"
#include "silpose/evaluate/uncertainty.h"
#include "silpose/experiment/score_parts.h"
#include "silpose/shape/keypoint_axes.h"

namespace silpose {
namespace {

constexpr double kMmPerMetre = 1000;
constexpr std::array<const char*, 2> kSides = {"right", "left"};

// Where the joints of a frame are, by name.
using Places = std::map<std::string, Eigen::Vector3d, std::less<>>;

std::map<int64_t, Places> places_of(const Recorded& recorded) {
  std::map<int64_t, Places> frames;
  if (!recorded.joints) return frames;
  for (const JointTable::Row& row : recorded.joints->rows) frames[row.frame].emplace(row.joint, row.x_in_world);
  return frames;
}

std::optional<Eigen::Vector3d> middle_of_hips(const Places& places) {
  const auto right = places.find("right_thigh"), left = places.find("left_thigh");
  if (right == places.end() || left == places.end()) return std::nullopt;
  return (right->second + left->second) / 2;
}

std::optional<double> knee_flexion_deg(const Places& places, const std::string& side) {
  const auto hip = places.find(side + "_thigh"), knee = places.find(side + "_shin"),
             ankle = places.find(side + "_foot");
  if (hip == places.end() || knee == places.end() || ankle == places.end()) return std::nullopt;
  return flexion_deg(hip->second, knee->second, ankle->second);
}

// Estimate minus truth, degrees; nothing where either lacks a joint.
std::optional<double> knee_error_deg(const Places& places, const Places& truth, const std::string& side) {
  const auto flexion = knee_flexion_deg(places, side), true_flexion = knee_flexion_deg(truth, side);
  if (!flexion || !true_flexion) return std::nullopt;
  return *flexion - *true_flexion;
}

double mean_knee_error_deg(const Places& places, const Places& truth) {
  std::vector<double> errors;
  for (const std::string side : kSides) {
    if (const auto error_deg = knee_error_deg(places, truth, side)) errors.push_back(std::abs(*error_deg));
  }
  return errors.empty() ? kAbsent : mean_of(errors);
}

// What was claimed of all joints and knees, and how far off they are.
struct Claims {
  std::vector<double> coordinate_errors, coordinate_deviations;  // m, root-aligned
  std::vector<double> joint_errors, joint_deviations;            // mm, root-aligned
  std::vector<double> knee_errors, knee_deviations;              // degrees
  std::vector<double> frame_errors, frame_deviations;            // mm, means over joints
};

// Adds those of one frame; returns the mean claimed deviation of its joints, mm, NaN where nothing is claimed.
double add_claims(const BodyModel& body, const StepReport& report, const Places& places, const Places& truth,
                  Claims& claims) {
  const auto middle = middle_of_hips(places), true_middle = middle_of_hips(truth);
  const std::vector<std::string> names = landmark_names(body);
  if (report.landmark_spread_about_root.size() != names.size() || report.spread.empty() || !middle || !true_middle)
    return kAbsent;
  std::vector<double> errors, deviations;
  for (size_t i = 0; i < names.size(); ++i) {
    const auto true_place = truth.find(names[i]);
    if (true_place == truth.end()) continue;
    const Eigen::Vector3d off = places.at(names[i]) - *middle - (true_place->second - *true_middle);
    for (int axis = 0; axis < 3; ++axis) {
      claims.coordinate_errors.push_back(off[axis]);
      claims.coordinate_deviations.push_back(report.landmark_spread_about_root[i][axis]);
    }
    errors.push_back(kMmPerMetre * off.norm());
    deviations.push_back(kMmPerMetre * report.landmark_spread_about_root[i].norm());
  }
  if (errors.empty()) return kAbsent;
  claims.joint_errors.insert(claims.joint_errors.end(), errors.begin(), errors.end());
  claims.joint_deviations.insert(claims.joint_deviations.end(), deviations.begin(), deviations.end());
  claims.frame_errors.push_back(mean_of(errors));
  claims.frame_deviations.push_back(mean_of(deviations));
  for (const std::string side : kSides) {
    const auto dof = std::ranges::find(body.skeleton.dofs(), side + "_shin_rx", &Dof::name);
    const auto error_deg = knee_error_deg(places, truth, side);
    if (dof == body.skeleton.dofs().end() || !error_deg) continue;
    const auto index = static_cast<size_t>(dof - body.skeleton.dofs().begin());
    claims.knee_errors.push_back(*error_deg);
    claims.knee_deviations.push_back(to_degrees(report.spread[index]));
  }
  return claims.frame_deviations.back();
}

double share_inside(const std::vector<double>& errors, const std::vector<double>& deviations) {
  const auto count = static_cast<Eigen::Index>(errors.size());
  return interval_coverage(Eigen::Map<const Eigen::VectorXd>(errors.data(), count),
                           Eigen::Map<const Eigen::VectorXd>(deviations.data(), count))[0];
}

void add_claim_scores(const Claims& claims, RunResult& run) {
  if (!claims.knee_errors.empty()) {
    run.scores["coverage_knee"] = share_inside(claims.knee_errors, claims.knee_deviations);
  }
  if (claims.joint_errors.empty()) return;
  run.scores["coverage_joint"] = share_inside(claims.coordinate_errors, claims.coordinate_deviations);
  run.scores["ece_joint"] = interval_calibration_error(claims.coordinate_errors, claims.coordinate_deviations);
  if (const auto correlation = rank_correlation(claims.joint_deviations, claims.joint_errors)) {
    run.scores["rank_correlation"] = *correlation;
  }
  std::vector<bool> is_wrong;
  for (const double error_mm : claims.joint_errors) is_wrong.push_back(error_mm > kWrongMm);
  if (const auto area = roc_area(claims.joint_deviations, is_wrong)) run.scores["roc_area_50mm"] = *area;
  for (const int percent : {100, 80, 60, 40}) {
    run.scores[fmt::format("risk_{}_mm", percent)] =
        mean_of_surest(claims.frame_errors, claims.frame_deviations, percent / 100.0);
  }
}

// Distances of points to the nearest of the vertices, mm. [P]
std::vector<double> distances_mm(const std::vector<Eigen::Vector3f>& points,
                                 const std::vector<Eigen::Vector3f>& vertices) {
  constexpr size_t kGrain = 64;
  const Eigen::Map<const Eigen::Matrix3Xf> all(vertices[0].data(), 3, static_cast<Eigen::Index>(vertices.size()));
  std::vector<double> distances(points.size());
  parallel_for(points.size(), kGrain, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const float squared = (all.colwise() - points[i]).colwise().squaredNorm().minCoeff();
      distances[i] = kMmPerMetre * std::sqrt(static_cast<double>(squared));
    }
  });
  return distances;
}

// A row's own columns, behind frame, time and the figures of evaluate/evaluation.h.
struct OwnColumns {
  double knee_error_deg = kAbsent, joint_sd_mm = kAbsent, surface_error_mm = kAbsent, surface_median_mm = kAbsent,
         observed_iou = kAbsent;
};

std::vector<std::string> all_columns() {
  std::vector<std::string> columns = {"frame", "time_s"};
  const std::vector<std::string> figures = figure_names();
  columns.insert(columns.end(), figures.begin(), figures.end());
  columns.insert(columns.end(),
                 {"knee_error_deg", "joint_sd_mm", "surface_error_mm", "surface_median_mm", "observed_iou"});
  return columns;
}

size_t column_of(const RunResult& run, const std::string& name) {
  return static_cast<size_t>(std::ranges::find(run.frame_columns, name) - run.frame_columns.begin());
}

// Puts a row together; `figures` may be null.
void add_row(int64_t frame, double time_s, const FrameEvaluation* figures, const OwnColumns& own, RunResult& run) {
  std::vector<double> row = {static_cast<double>(frame), time_s};
  for (size_t k = 0; k < figure_names().size(); ++k) {
    row.push_back(figures != nullptr ? figures->values[k].value_or(kAbsent) : kAbsent);
  }
  row.insert(row.end(),
             {own.knee_error_deg, own.joint_sd_mm, own.surface_error_mm, own.surface_median_mm, own.observed_iou});
  run.frames.push_back(std::move(row));
}

// Scores that are computed from the rows alone.
void add_row_scores(bool has_joints, RunResult& run) {
  for (size_t column = 2; column < run.frame_columns.size(); ++column) {
    add_mean_and_deviation(run.frame_columns[column], run.frames, column, run);
  }
  if (!has_joints) return;
  std::vector<double> root_errors;
  double worst = -1;
  for (const std::vector<double>& row : run.frames) {
    root_errors.push_back(row[column_of(run, "joint_error_root_mm")]);
    if (std::isfinite(root_errors.back())) worst = std::max(worst, root_errors.back());
  }
  if (worst >= 0) run.scores["worst_frame_mm"] = worst;
  add_verdicts(root_errors, run);
}

std::map<int64_t, const FrameEvaluation*> by_frame(const std::vector<FrameEvaluation>& frames) {
  std::map<int64_t, const FrameEvaluation*> found;
  for (const FrameEvaluation& frame : frames) found.emplace(frame.frame, &frame);
  return found;
}

template <class Map>
const typename Map::mapped_type* find_in(const Map& map, int64_t frame) {
  const auto found = map.find(frame);
  return found == map.end() ? nullptr : &found->second;
}

// The network's keypoints as the tables of a result, relative to the middle of the hips.
Recorded recorded_keypoints(const BodyModel& body, const PinholeCamera& camera, std::span<const ClipInstant> clip) {
  Recorded result;
  result.joints.emplace();
  const std::vector<std::string> names = landmark_names(body);
  for (const ClipInstant& instant : clip) {
    const Observation& seen = instant.observations[0];
    if (seen.keypoints_3d.empty()) continue;
    const Eigen::Matrix3d world_from_points = world_from_keypoints(camera, seen.keypoints_3d);
    for (const Keypoint3D& point : seen.keypoints_3d.points) {
      if (std::ranges::find(names, point.name) == names.end()) continue;
      const auto landmark = std::ranges::find(seen.keypoints_2d, point.name, &Keypoint2D::name);
      const bool is_seen = landmark != seen.keypoints_2d.end();
      result.joints->rows.push_back(
          {.frame = instant.frame_idx,
           .time_s = static_cast<double>(instant.time_ns) * 1e-9,
           .joint = point.name,
           .x_in_world = world_from_points * Eigen::Vector3d(point.x[0], point.x[1], point.x[2]),
           .pixel = is_seen ? Eigen::Vector2d(landmark->x, landmark->y) : Eigen::Vector2d(kAbsent, kAbsent)});
    }
  }
  return result;
}

}  // namespace

Result<RunResult> score_clip(const ClipTruth& truth, const BodyModel& body, std::span<const PinholeCamera> cameras,
                             std::span<const StepReport> reports) {
  check(!reports.empty() && !cameras.empty(), "score_clip: {} reports, {} cameras", reports.size(), cameras.size());
  const Recorded result =
      recorded_of(body, cameras[0], reports, [](const StepReport& report) { return report.time_s(); });
  const std::map<int64_t, Places> places = places_of(result);
  std::map<int64_t, Places> true_places;
  std::vector<FrameEvaluation> figures;
  if (truth.joints) {
    true_places = places_of(*truth.joints);
    Result<std::vector<FrameEvaluation>> evaluated = evaluate_frames(result, *truth.joints, body);
    if (!evaluated) return evaluated.failure();
    figures = std::move(*evaluated);
  }
  const auto figures_of = by_frame(figures);

  RunResult run;
  run.frame_columns = all_columns();
  Claims claims;
  int64_t num_missing = 0;
  for (const StepReport& report : reports) {
    OwnColumns own;
    const bool has_pose = !report.pose.empty();
    num_missing += has_pose ? 0 : 1;
    if (has_pose && report.visual_accuracy > 0) own.observed_iou = report.visual_accuracy;
    const Places* const true_place = find_in(true_places, report.frame_idx);
    if (has_pose && true_place != nullptr) {
      const Places& place = places.at(report.frame_idx);
      own.knee_error_deg = mean_knee_error_deg(place, *true_place);
      own.joint_sd_mm = add_claims(body, report, place, *true_place, claims);
    }
    const auto surface = std::ranges::find(truth.surfaces, report.frame_idx, &TrueSurface::frame);
    if (has_pose && surface != truth.surfaces.end()) {
      std::vector<double> distances = distances_mm(surface->points, skin_vertices(body, report.pose));
      own.surface_error_mm = mean_of(distances);
      own.surface_median_mm = upper_median(std::move(distances));
    }
    const FrameEvaluation* const* const found = find_in(figures_of, report.frame_idx);
    add_row(report.frame_idx, report.time_s(), found != nullptr ? *found : nullptr, own, run);
  }
  run.scores["frames"] = static_cast<double>(reports.size());
  run.scores["frames_missing"] = static_cast<double>(num_missing);
  add_row_scores(truth.joints.has_value(), run);
  add_claim_scores(claims, run);
  return run;
}

Result<RunResult> score_keypoints(const ClipTruth& truth, const BodyModel& body, const PinholeCamera& camera,
                                  std::span<const ClipInstant> clip) {
  check(!clip.empty(), "score_keypoints: no instants");
  if (!truth.joints) return error("a network's keypoints are scored against joints, not surfaces");
  const Recorded result = recorded_keypoints(body, camera, clip);
  const auto figures = evaluate_frames(result, *truth.joints, body);
  if (!figures) return figures.failure();
  const auto figures_of = by_frame(*figures);
  const std::map<int64_t, Places> places = places_of(result), true_places = places_of(*truth.joints);

  RunResult run;
  run.frame_columns = all_columns();
  const size_t absolute = column_of(run, "joint_error_mm");
  int64_t num_missing = 0;
  for (const ClipInstant& instant : clip) {
    OwnColumns own;
    const Places *const place = find_in(places, instant.frame_idx), *const true_place =
                                                                        find_in(true_places, instant.frame_idx);
    num_missing += place == nullptr ? 1 : 0;
    if (place != nullptr && true_place != nullptr) own.knee_error_deg = mean_knee_error_deg(*place, *true_place);
    const FrameEvaluation* const* const found = find_in(figures_of, instant.frame_idx);
    add_row(instant.frame_idx, static_cast<double>(instant.time_ns) * 1e-9, found != nullptr ? *found : nullptr, own,
            run);
    run.frames.back()[absolute] = kAbsent;
  }
  run.scores["frames"] = static_cast<double>(clip.size());
  run.scores["frames_missing"] = static_cast<double>(num_missing);
  add_row_scores(true, run);
  return run;
}

}  // namespace silpose
