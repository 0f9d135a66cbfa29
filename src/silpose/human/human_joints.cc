#include "silpose/human/human_joints.h"

#include <Eigen/Geometry>
#include <string>

namespace silpose {
namespace {

using Eigen::Vector3d;

struct LandmarkRow {
  std::vector<uint32_t> right, left;
};

// In the order of Landmark. Chosen by eye on lean, muscular bodies, whose bones show, and checked by people's breadths
// and heights of these landmarks (human_joints_test.cc).
const std::array<LandmarkRow, kNumLandmarks>& rows() {
  static const std::array<LandmarkRow, kNumLandmarks> table = {{
      {{4318, 4321, 4324, 4327}, {10947, 10950, 10952, 10955}},  // where the groin's fold begins
      {{4191, 4192, 4390, 4392}, {10830, 10831, 11008, 11010}},  // the dimples over the sacrum
      {{4629, 4630, 4648, 4649}, {11247, 11248, 11266, 11267}},  // at the height of the patella's middle
      {{6406, 4637}, {13003, 11255}},
      {{4826, 6240, 6440}, {11444, 12837, 13036}},  // where the malleoli reach furthest out
      {{6345, 6343}, {12942, 12940}},
      {{1557, 1558, 1603, 1604}, {8235, 8236, 8275, 8276}},  // where the shoulder's slope breaks
      {{3387, 3388, 3405}, {10055, 10056, 10073}},           // at the height of the olecranon
      {{3410, 3411}, {10078, 10079}},
      {{3771, 3922}, {10438, 10587}},  // where the wrist is thinnest, before the thumb begins
      {{3806, 3903}, {10472, 10568}},
  }};
  return table;
}

// Of the joints 0 to 3, in the MakeHuman rig (references.bib: makehuman).
constexpr std::array<const char*, 4> kTrunkCubes = {"joint-pelvis", "joint-spine-4", "joint-spine-2", "joint-neck"};

}  // namespace

std::span<const uint32_t> landmark_vertices(Landmark landmark, Side side) {
  const LandmarkRow& row = rows()[static_cast<size_t>(landmark)];
  return side == Side::kRight ? row.right : row.left;
}

Vector3d landmark_place(std::span<const Vector3d> vertices, Landmark landmark, Side side) {
  Vector3d sum = Vector3d::Zero();
  const std::span<const uint32_t> those = landmark_vertices(landmark, side);
  for (const uint32_t v : those) sum += vertices[v];
  return sum / static_cast<double>(those.size());
}

HipCentres hip_centres(const PelvisSpines& spines) {
  const Vector3d front = (spines.right_front + spines.left_front) / 2,
                 back = (spines.right_back + spines.left_back) / 2;
  const double width = (spines.left_front - spines.right_front).norm(), depth = (front - back).norm();
  const Vector3d left = (spines.left_front - spines.right_front) / width;
  const Vector3d superior = (front - back).cross(left).normalized();
  const Vector3d anterior = left.cross(superior);
  // Source of all coefficients: harrington2007.
  const Vector3d middle = front + (-0.24 * depth - 0.0099) * anterior + (-0.30 * width - 0.0109) * superior;
  const Vector3d lateral = (0.33 * width + 0.0073) * left;
  return {.right = middle - lateral, .left = middle + lateral};
}

Vector3d shoulder_centre(const Vector3d& acromion, const Vector3d& other_acromion, const Vector3d& elbow) {
  // Source: 0.17, rab2002; 0.104 and 0.043, deleva1996b. Their mean: human_joints.h.
  const double by_breadth = 0.17 * (acromion - other_acromion).norm();
  const double by_length = 0.104 * (acromion - elbow).norm() / (1 - 0.043);
  return acromion - (by_breadth + by_length) / 2 * Vector3d::UnitY();
}

Vector3d cube_centre(const MakeHumanMesh& base, std::span<const Vector3d> vertices, const std::string& cube) {
  Vector3d sum = Vector3d::Zero();
  for (const uint32_t v : base.cubes.at(cube)) sum += vertices[v];
  return sum / 8;  // corners
}

std::array<Vector3d, 20> joint_centres(const MakeHumanMesh& base, std::span<const Vector3d> vertices,
                                       std::span<const Vector3d> average_build) {
  std::array<Vector3d, 20> out;
  for (size_t j = 0; j < kTrunkCubes.size(); ++j) out[j] = cube_centre(base, vertices, kTrunkCubes[j]);
  const auto average = [&](Landmark landmark, Side side) { return landmark_place(average_build, landmark, side); };
  const HipCentres hips = hip_centres({.right_front = average(Landmark::kFrontSpine, Side::kRight),
                                       .left_front = average(Landmark::kFrontSpine, Side::kLeft),
                                       .right_back = average(Landmark::kBackSpine, Side::kRight),
                                       .left_back = average(Landmark::kBackSpine, Side::kLeft)});
  for (const Side side : {Side::kRight, Side::kLeft}) {
    const std::string prefix = side == Side::kRight ? "joint-r-" : "joint-l-";
    const size_t leg = side == Side::kRight ? 4 : 8, arm = leg + 8;
    const auto middle = [&](Landmark a, Landmark b) -> Vector3d {
      return (landmark_place(vertices, a, side) + landmark_place(vertices, b, side)) / 2;
    };
    const std::string rig_hip = prefix + "upper-leg";
    out[leg] = (side == Side::kRight ? hips.right : hips.left) + cube_centre(base, vertices, rig_hip) -
               cube_centre(base, average_build, rig_hip);
    out[leg + 1] = out[leg];  // the zero-DOF hip shares the thigh's
    out[leg + 2] = middle(Landmark::kLateralFemoralEpicondyle, Landmark::kMedialFemoralEpicondyle);
    out[leg + 3] = middle(Landmark::kLateralMalleolus, Landmark::kMedialMalleolus);
    out[arm] = cube_centre(base, vertices, prefix + "clavicle");
    out[arm + 2] = middle(Landmark::kLateralHumeralEpicondyle, Landmark::kMedialHumeralEpicondyle);
    const Side other = side == Side::kRight ? Side::kLeft : Side::kRight;
    out[arm + 1] = shoulder_centre(landmark_place(vertices, Landmark::kAcromion, side),
                                   landmark_place(vertices, Landmark::kAcromion, other), out[arm + 2]);
    out[arm + 3] = middle(Landmark::kRadialStyloid, Landmark::kUlnarStyloid);
  }
  return out;
}

}  // namespace silpose
