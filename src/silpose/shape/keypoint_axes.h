// The axes of a network's keypoints, and the errors of the limb directions that the network finds.
// Threads: constants and a function without state.
#pragma once

#include <Eigen/Core>
#include <string_view>

#include "silpose/geometry/camera.h"
#include "silpose/image/keypoints3d.h"

namespace silpose {

// The rotation from the axes of the keypoints to the world's.
Eigen::Matrix3d world_from_keypoints(const PinholeCamera& camera, const Keypoints3D& keypoints);

// Error of a segment's unit vector, one standard deviation: each axis in the image, and in depth.
// [measured: BlazePose against marker motion capture and triangulated keypoints, nine takes of some five people]
struct DirectionError {
  double in_image = 0, in_depth = 0;
};
inline constexpr DirectionError kTrunkError = {.06, .18};      // middle of the hips to that of the shoulders
inline constexpr DirectionError kHipsError = {.12, .15};       // from hip to hip
inline constexpr DirectionError kShouldersError = {.10, .12};  // from shoulder to shoulder

// What the network calls the keypoints of the hips and the shoulders.
struct KeypointPair {
  std::string_view right, left;
};
inline constexpr KeypointPair kHipKeypoints = {"right_thigh", "left_thigh"},
                              kShoulderKeypoints = {"right_upper_arm", "left_upper_arm"};

// A segment from one keypoint to another, both without their side; `forward_bias` of its unit vector lies too far
// forward, in the subject's own frame. [measured on the same]
struct LimbSegment {
  std::string_view from, to;
  DirectionError error;
  double forward_bias = 0;
};
inline constexpr LimbSegment kLimbSegments[] = {
    {"upper_arm", "forearm", {.12, .30}, .15},
    {"forearm", "hand", {.15, .38}, .10},
    {"thigh", "shin", {.12, .18}, 0},
    {"shin", "foot", {.10, .18}, .08},
};

}  // namespace silpose
