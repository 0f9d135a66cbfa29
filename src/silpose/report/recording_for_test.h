// A small body and what was tracked of it, for this module's tests.
#pragma once

#include "silpose/body/body_model.h"
#include "silpose/recording/track_recording.h"

namespace silpose {

// A root that moves sideways and turns without end, and an elbow below it.
inline BodyModel arm_body() {
  Joint root{.name = "root", .dof_indices = {0, 1}};
  Joint elbow{.name = "right_elbow", .parent_idx = 0, .offset_in_parent = {0, -0.3, 0}, .dof_indices = {2}};
  Dof move{.name = "root_tx", .is_translation = true, .lower = -1, .upper = 1};
  Dof turn{.name = "root_rx", .is_periodic = true, .lower = -kPi, .upper = kPi};
  Dof bend{.name = "right_forearm_rx", .joint_idx = 1, .lower = 0, .upper = kPi / 2};
  return {.name = "arm",
          .skeleton = Skeleton("arm", {root, elbow}, {move, turn, bend}),
          .end_points = {{"right_tip", 1, {0, -0.2, 0}}}};
}

// Waiting, tracked, coasted.
inline TrackRecording three_frames() {
  TrackRecording recording;
  recording.skeleton = "arm";
  recording.cameras = {"front"};
  recording.steps.push_back({.frame_idx = 60, .time_ns = 2'000'000'000, .trust = {0}});
  recording.steps.push_back({.frame_idx = 61,
                             .time_ns = 2'033'333'333,
                             .state = StepReport::State::kTracked,
                             .pose = {0.5, 0, kPi / 6},
                             .spread = {0.02, 0, kPi / 180},
                             .visual_accuracy = 0.875,
                             .effective_sample_size = 100,
                             .trust = {0.75}});
  recording.steps.push_back({.frame_idx = 62,
                             .time_ns = 2'066'666'667,
                             .state = StepReport::State::kCoasted,
                             .pose = {0.5, 0, kPi / 6},
                             .spread = {0.04, 0, kPi / 90},
                             .trust = {}});
  return recording;
}

}  // namespace silpose
