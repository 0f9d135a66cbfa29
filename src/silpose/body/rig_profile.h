// RigProfile: what else than joints and DOF there is to know about a rig: how it moves and stands, which parts are
// limbs, from which poses to start. Motion models, the tracker and the evaluation read it and no names of joints or
// DOF. Indices are those of the skeleton that it was made for. `human_profile()` fills it for the human,
// `default_profile()` derives it for any other rig; a body keeps it (BodyModel::profile, .body files). Threads: a
// value; functions without state.
#pragma once

#include <Eigen/Core>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "silpose/body/skeleton.h"

namespace silpose {

inline constexpr double kNoiseInterval_s = 1.0 / 30;  // the interval that deviations of motion are stated for

// A part of the rig that can be posed by itself.
struct Limb {
  std::vector<int> joints;  // a chain, from the trunk outwards
  std::vector<int> dofs;    // ascending, not empty: of these joints, and of what hangs from them
};

struct RigProfile {
  // Indices into `limbs`. Their DOF correspond in order, and equal values are mirror images.
  struct LimbPair {
    size_t right = 0, left = 0;
  };
  struct JointPair {
    int right = 0, left = 0;
  };
  // A joint, or an end point, whose position is evaluated; what other formats call it: {"openpose", "RKnee"}. The names
  // that a network gives its keypoints are those of format "keypoints".
  struct Landmark {
    std::string name;
    std::map<std::string, std::string> other_names = {};
  };
  struct NamedPose {
    std::string name;
    std::vector<double> pose;  // [D] heading and root translation 0
  };

  std::vector<int> root_translations;         // DOF that move the whole rig, along orthogonal axes: 0 to 3
  std::optional<int> heading;                 // DOF by which it turns about the vertical: none outside of it turns it
  std::optional<Eigen::Vector3d> up, facing;  // unit vectors in the root's frame; none: it has no upright, or no front
  std::vector<Limb> limbs;                    // in order of their first joint; no DOF is in two
  std::vector<LimbPair> limb_pairs;
  std::vector<JointPair> across;    // what joins the trunk right and left: hips, shoulders
  std::vector<int> contact_joints;  // whose flesh, and that of joints below them, it stands on
  std::vector<Landmark> landmarks;
  std::vector<std::string> origin;  // landmarks whose mean is the origin of root-aligned errors

  // Standard deviations [D], radians and metres. `noise`: of a move within kNoiseInterval_s. `acceleration`: of the
  // change of velocity in that interval, times the interval. `rest`: from zero, in most poses; 0: may be anywhere.
  // `rest_if_seen`: the same where the directions of limbs are measured besides.
  std::vector<double> noise, acceleration, rest, rest_if_seen;

  std::vector<NamedPose> poses;  // to start from, the most common first
  double silhouette_area = 0;    // of an upright silhouette, over the body's height squared; 0: not known

  // The name of the landmark that `format` calls `other_name`; empty: none.
  [[nodiscard]] std::string_view landmark_called(std::string_view other_name, std::string_view format) const;
  // Whether a landmark of that name is evaluated.
  [[nodiscard]] bool has_landmark(std::string_view name) const;
};

// What the tree alone shows. Limbs: chains that branch from the trunk, longer than a fifth of the longest chain; cut
// into pieces of at most four moving joints. Pairs: limbs whose DOF have the same names but for right_ and left_, or
// mirror each other in the plane x = 0. Heading: the outermost rotation of the root, if it is about the vertical.
[[nodiscard]] RigProfile tree_profile(const Skeleton& skeleton);

// For a skeleton that has the profile's DOF and others after them, which get default deviations.
[[nodiscard]] RigProfile extended(RigProfile profile, const Skeleton& skeleton);

// Errors: throws std::invalid_argument where an index, a size or a number does not suit the skeleton.
void check_profile(const RigProfile& profile, const Skeleton& skeleton);

// On which side of the body a joint is: that of the limb it is in, or hangs from, if it has a partner.
enum class BodySide { kMiddle, kRight, kLeft };
[[nodiscard]] BodySide side_of(const RigProfile& profile, const Skeleton& skeleton, int joint_idx);

// Sets the profile's root translations so that the joint that they move is at `root_in_world`, metres; all else in the
// pose [D] stays. With fewer than three it is moved as near as possible, and within the limits; without any it is not
// moved.
// Errors: throws std::invalid_argument for a pose of another size.
void place_root(const Skeleton& skeleton, const RigProfile& profile, std::span<double> pose,
                const Eigen::Vector3d& root_in_world);

}  // namespace silpose
