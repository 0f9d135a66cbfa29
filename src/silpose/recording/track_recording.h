// TrackRecording: what a tracker reported about a clip, frame by frame, as plain values, and the tables that exchange
// writes. The recording is the result: files and reports are made from it, never from the tracker.
// Threads: values and pure functions.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "silpose/body/body_model.h"
#include "silpose/exchange/tables.h"
#include "silpose/exchange/trc.h"
#include "silpose/geometry/camera.h"
#include "silpose/track/step_report.h"

namespace silpose {

struct RecordedStep {
  int64_t frame_idx = 0;
  int64_t time_ns = 0;
  StepReport::State state = StepReport::State::kWaiting;
  std::vector<double> pose, mode, spread;        // [D] metres, radians; empty while waiting
  std::vector<Eigen::Vector3d> landmark_spread;  // [J + E] metres; empty while waiting
  double visual_accuracy = 0, effective_sample_size = 0;
  std::vector<double> trust;  // [C] how far each camera's mask could be relied on, 0 to 1; NaN where not reported
};

struct TrackRecording {
  std::string skeleton;              // its name
  std::vector<RecordedStep> steps;   // [T] in time order
  std::vector<std::string> cameras;  // [C] by name, of those that report their trust
};

// Of reports in time order; `cameras`: the names of those that report their trust, [C].
TrackRecording recording_of(std::span<const StepReport> reports, const std::string& skeleton,
                            const std::vector<std::string>& cameras);

// "waiting", "initialised", "tracked", "coasted".
std::string_view state_name(StepReport::State state);

// Tables of the steps that have a pose. The spread table holds standard deviations in the poses' own units.
PoseTable pose_table(const TrackRecording& recording);
PoseTable normalised_pose_table(const TrackRecording& recording, const Skeleton& skeleton);
PoseTable spread_table(const TrackRecording& recording);
// Every joint, and the end points that are landmarks of the rig, with its pixel in `camera` and its spread.
JointTable joint_table(const TrackRecording& recording, const BodyModel& body, const PinholeCamera& camera);

// Every joint and end point as a marker, one row per frame; without positions where the body was not compared with a
// silhouette: waiting, coasted.
MarkerTable marker_table(const TrackRecording& recording, const BodyModel& body);

// Poses [T][D] at an even rate, as motion files want them, from the first step that has a pose to the last: those of
// the steps where they lie on that grid, otherwise between the two around it in time. REQUIRES: fps > 0.
std::vector<std::vector<double>> even_poses(const TrackRecording& recording, const Skeleton& skeleton, double fps);

// Counts and means over a recording.
struct RecordingSummary {
  int64_t frames = 0, frames_tracked = 0, frames_coasted = 0;  // tracked: compared with a silhouette
  double visual_accuracy_mean = 0, visual_accuracy_std = 0;    // over tracked frames; NaN when there is none
};
RecordingSummary summarise(const TrackRecording& recording);

}  // namespace silpose
