// What retargeting must know about a recorded clip: which joint is what, how its rest pose is oriented, which way is
// up, how a flat foot slopes, which frames to take. For use inside module body only.
// Threads: functions without state.
#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/mocap/clip.h"

namespace silpose::retarget_source {

inline constexpr std::array kSides{"left_", "right_"};

// Where the parts of the clip's skeleton are: indices of its joints; -1: not there.
struct Parts {
  int root = -1, chest = -1, neck = -1, head = -1;
  struct Limbs {
    int thigh = -1, shin = -1, foot = -1, toe = -1, upper_arm = -1, forearm = -1, hand = -1, finger = -1;
  };
  std::array<Limbs, 2> side;
};

// Errors: joints that have no match; names them.
Result<Parts> find_parts(const Clip& clip);

// Joints [J] in the rest pose.
std::vector<Rigid3> rest_pose(const Clip& clip);
Eigen::Vector3d middle(std::span<const Rigid3> joints, int a, int b);
double distance(std::span<const Rigid3> joints, int a, int b);

// Columns left, up and forward of the body in the clip's rest pose, in clip coordinates.
Eigen::Matrix3d rest_axes(std::span<const Rigid3> rest, const Parts& parts);

// Whether z is up in the clip's world: determined from the rest pose, unless in the motion itself the body is upright
// along the other axis.
bool is_z_up(const Clip& clip, const Parts& parts, const Eigen::Vector3d& rest_up);

// How ankle to toe base slopes while the sole is flat, radians: it differs from rig to rig, and captures are rarely
// calibrated for it. Estimated from the flattest tenth of the quarter of frames in which the foot moves least, near the
// slope in the rest pose. `rest_up`, `up`: of the rest pose and of the clip's world.
double flat_foot_pitch(const Clip& clip, int foot, int toe, const Eigen::Vector3d& rest_up, const Eigen::Vector3d& up);

// Of the joints that are turned in the second frame, three quarters are not in the first.
bool opens_at_rest(const Clip& clip);

// Times at `fps` over frames [first, T), in frames of the clip.
std::vector<double> sample_times(const Clip& clip, size_t first, double fps);

}  // namespace silpose::retarget_source
