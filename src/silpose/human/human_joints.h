// Where the joints of a shaped MakeHuman mesh are: centres of rotation, from bony landmarks that can be seen on its
// skin. Private to the module `body`.
// Source: hip: regression on the pelvis (references.bib: harrington2007); knee, ankle: midpoints of the femoral
// epicondyles and of the malleoli (wu2002); elbow, wrist: midpoints of the humeral epicondyles and of the styloids
// (wu2005); shoulder: below the acromion (rab2002, deleva1996b). Trunk, clavicle: the MakeHuman rig's (makehuman).
// Landmarks are means of a few skin vertices. Around a limb the skin is about equally thick on both sides, so that it
// does not move midpoints. At the pelvis it is not: it is 10 mm thick over the anterior spines and 20 mm over the
// posterior ones (mantovani2016), so that hips are 3 mm too far forward, uncorrected.
// Threads: functions without state.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "silpose/human/makehuman_files.h"

namespace silpose {

enum class Landmark {
  kFrontSpine,  // anterior superior iliac spine
  kBackSpine,   // posterior superior iliac spine
  kLateralFemoralEpicondyle,
  kMedialFemoralEpicondyle,
  kLateralMalleolus,
  kMedialMalleolus,
  kAcromion,  // its lateral edge
  kLateralHumeralEpicondyle,
  kMedialHumeralEpicondyle,
  kRadialStyloid,
  kUlnarStyloid
};
inline constexpr int kNumLandmarks = 11;
enum class Side { kRight, kLeft };

// Vertices of the base mesh on that landmark. Those of the right are the mirror images of the left's.
[[nodiscard]] std::span<const uint32_t> landmark_vertices(Landmark landmark, Side side);

// Their mean, in the unit of `vertices` [19158 or 13380].
[[nodiscard]] Eigen::Vector3d landmark_place(std::span<const Eigen::Vector3d> vertices, Landmark landmark, Side side);

// The four spines of a pelvis, metres.
struct PelvisSpines {
  Eigen::Vector3d right_front, left_front, right_back, left_back;
};
struct HipCentres {
  Eigen::Vector3d right, left;
};
// Anterior, superior and lateral of the middle between the front spines, in the plane of all four, by pelvis width and
// depth. Source: harrington2007, regressions on one variable each.
[[nodiscard]] HipCentres hip_centres(const PelvisSpines& spines);

// Straight below the acromion, by the mean of two rules: 17 % of the distance between the acromia (rab2002), and 10.4 %
// of that from acromion to radiale, where the elbow is 4.3 % of it above the radiale (deleva1996b). At a stature of
// 1.70 m these are 63 and 32 mm. A third rule, with other landmarks, gives 51 mm (dumas2007). With the mean the hanging
// arms are as far apart as people's. Source: references.bib: rab2002, deleva1996b.
[[nodiscard]] Eigen::Vector3d shoulder_centre(const Eigen::Vector3d& acromion, const Eigen::Vector3d& other_acromion,
                                              const Eigen::Vector3d& elbow);

// Joint centres [20] in joint order (docs/formats.md), metres. `vertices` [19158]: the shape, metres, Y up.
// `average_build` [19158]: the same person of average weight and muscle. The hips are found on that one, where little
// fat covers the spines, and are moved with the rig's hip to the shape itself.
[[nodiscard]] std::array<Eigen::Vector3d, 20> joint_centres(const MakeHumanMesh& base,
                                                            std::span<const Eigen::Vector3d> vertices,
                                                            std::span<const Eigen::Vector3d> average_build);

// The middle of a cube "joint-..." of the base mesh, in the unit of `vertices` [19158].
[[nodiscard]] Eigen::Vector3d cube_centre(const MakeHumanMesh& base, std::span<const Eigen::Vector3d> vertices,
                                          const std::string& cube);

}  // namespace silpose
