// Motions whose truth is known: poses by name ("static", "dof:6", "sway", "circle", "random", "walk.bvh",
// "humanoid3d_walk.txt").
// None of them comes from the motion models of the tracker, so that truth is not drawn from the model under test.
// Threads: functions without state.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/body/body_model.h"
#include "silpose/mocap/clip.h"

namespace silpose {

struct SyntheticMotionOptions {
  int num_frames = 0;  // 0: the whole clip of a motion file; 80 of any other motion
  double fps = 30;
  std::optional<double> amplitude_deg;  // of sway (8), of the legs on the circle (25), of random (25)
  std::optional<double> period_s;       // of dof (the whole sequence), sway (4), one lap of the circle (6), random (2)
  uint64_t seed = 1;                    // of static and random
};

struct SyntheticMotion {
  std::vector<std::vector<double>> poses;  // [T][D] metres, radians, inside the limits
  double fps = 30;
  // Of a motion file: angle between its limbs and ours, degrees; see mocap/retarget.h.
  std::optional<double> mean_residual_deg, max_residual_deg;
};

// The motion called `name`; one that ends as a motion file does (exchange/clip_file.h) is read.
// Errors: unknown motion; a DOF that is not a number or out of range; an unreadable motion file, or one that is too
// short.
Result<SyntheticMotion> make_motion(const std::string& name, const BodyModel& body,
                                    const SyntheticMotionOptions& options = {});

// A pose drawn by seed: every angle between zero and most of the way to a limit, facing roughly forward, lowest point
// on the floor. For a human also plausible: hands and elbows outside the trunk, knees and feet apart, no handstand. [D]
std::vector<double> draw_static_pose(const BodyModel& body, uint64_t seed);

// One DOF swings over its whole range and back once every period; all others stay zero, standing. [T][D]
// Errors: throws std::invalid_argument for an index out of range.
std::vector<std::vector<double>> sweep_dof(const BodyModel& body, int dof_idx, const SyntheticMotionOptions& options);

// A human leans over the ankles in a slow figure of eight, arms swinging; any other body swings all of its angles.
std::vector<std::vector<double>> sway(const BodyModel& body, const SyntheticMotionOptions& options);

// Walks around a circle of 1 m radius about the origin, swinging arms and legs. Other bodies just move along it.
std::vector<std::vector<double>> walk_circle(const BodyModel& body, const SyntheticMotionOptions& options);

// Every angle a sum of sinusoids no faster than the period, around a relaxed standing pose; drawn by seed.
std::vector<std::vector<double>> random_smooth(const BodyModel& body, const SyntheticMotionOptions& options);

// A clip retargeted, its first num_frames. Errors: those of retarget(); too few frames.
Result<SyntheticMotion> motion_from_clip(const Clip& clip, const BodyModel& body,
                                         const SyntheticMotionOptions& options);

// The body's lowest point in a pose, metres.
double lowest_point(const BodyModel& body, const std::vector<double>& pose);

}  // namespace silpose
