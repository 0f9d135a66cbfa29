// build_human(): the shaped mesh on the thesis' skeleton, with the rotations that carry its A-pose to the zero pose.
#include <Eigen/Geometry>
#include <array>

#include "silpose/base/check.h"
#include "silpose/body/human_profile.h"
#include "silpose/human/human.h"
#include "silpose/human/human_joints.h"
#include "silpose/human/human_shape.h"
#include "silpose/human/makehuman_assets.h"

namespace silpose {
namespace {

enum HumanJoint { kThigh = 5, kShin = 6, kFoot = 7, kUpperArm = 13, kForearm = 14, kHand = 15, kToLeft = 4 };
constexpr int kHead = 3;

// How the joints were placed: a fact of every body. Another value for every change of human_joints.cc.
constexpr const char* kJointPlacesFact = "joint_places";
constexpr const char* kJointPlaces = "bony landmarks 1";

// The shaped mesh in silpose's frame: metres, floor at y = 0.
class RestPose {
 public:
  RestPose(const MakeHumanMesh& base, const std::vector<Eigen::Vector3f>& in_decimetres) : base_(base) {
    for (const Eigen::Vector3f& x : in_decimetres) vertices_.push_back(0.1 * x.cast<double>());
    const Eigen::Vector3d floor(0, centre("joint-ground").y(), 0);
    for (Eigen::Vector3d& x : vertices_) x -= floor;
  }
  Eigen::Vector3d centre(const std::string& cube) const { return cube_centre(base_, vertices_, cube); }
  const std::vector<Eigen::Vector3d>& vertices() const { return vertices_; }

 private:
  const MakeHumanMesh& base_;
  std::vector<Eigen::Vector3d> vertices_;
};

// The rotation that takes direction `a` to `b` and, as far as that allows, `a_side` to `b_side`.
Eigen::Matrix3d align(const Eigen::Vector3d& a, const Eigen::Vector3d& a_side, const Eigen::Vector3d& b,
                      const Eigen::Vector3d& b_side) {
  const auto basis = [](const Eigen::Vector3d& u, const Eigen::Vector3d& side) {
    Eigen::Matrix3d m;
    m.col(0) = u.normalized();
    m.col(1) = m.col(0).cross(side).normalized();
    m.col(2) = m.col(0).cross(m.col(1));
    return m;
  };
  return basis(b, b_side) * basis(a, a_side).transpose();
}

// By joint, the rotation from the rest pose to the zero pose: legs straight and vertical with the feet forward, arms
// straight down, palms to the thighs. The trunk rests upright already.
std::array<Eigen::Matrix3d, 20> zero_from_rest(const RestPose& rest, const std::array<Eigen::Vector3d, 20>& x) {
  const Eigen::Vector3d left = Eigen::Vector3d::UnitX(), up = Eigen::Vector3d::UnitY();
  const Eigen::Vector3d forward = Eigen::Vector3d::UnitZ();
  std::array<Eigen::Matrix3d, 20> out;
  out.fill(Eigen::Matrix3d::Identity());
  for (const int side : {0, +kToLeft}) {
    const std::string prefix = side == 0 ? "joint-r-" : "joint-l-";
    const Eigen::Vector3d thigh = x[kShin + side] - x[kThigh + side], shin = x[kFoot + side] - x[kShin + side];
    out[kThigh + side] = align(thigh, left, -up, left);
    out[kShin + side] = align(shin, left, -up, left);
    // The sole lies on the floor already: the foot only turns about the vertical.
    Eigen::Vector3d foot = rest.centre(prefix + "toe-2-1") - x[kFoot + side];
    foot.y() = 0;
    out[kFoot + side] = align(foot, up, forward, up);

    const Eigen::Vector3d upper_arm = x[kForearm + side] - x[kUpperArm + side];
    const Eigen::Vector3d forearm = x[kHand + side] - x[kForearm + side];
    const Eigen::Vector3d elbow_axis = upper_arm.cross(forearm);  // the rest pose bends the elbow forward
    out[kUpperArm + side] = align(upper_arm, elbow_axis, -up, -left);
    out[kForearm + side] = align(forearm, elbow_axis, -up, -left);
    const Eigen::Vector3d fingers = rest.centre(prefix + "finger-3-1") - x[kHand + side];
    const Eigen::Vector3d across = rest.centre(prefix + "finger-2-1") - rest.centre(prefix + "finger-5-1");
    out[kHand + side] = align(fingers, across, -up, forward);
  }
  return out;
}

std::string text_of_sex(double sex) { return sex == 0 ? "m" : sex == 1 ? "f" : fmt::format("{:g}", sex); }

std::map<std::string, std::string> facts_of(const MakeHumanAssets& assets, const Sliders& sliders) {
  return {{"source", "MakeHuman (CC0)"},
          {"source_sha256", assets.hash},
          {kJointPlacesFact, kJointPlaces},
          {"slider_gender", fmt::format("{:.6f}", sliders.gender)},
          {"slider_age", fmt::format("{:.6f}", sliders.age)},
          {"slider_muscle", fmt::format("{:.6f}", sliders.muscle)},
          {"slider_weight", fmt::format("{:.6f}", sliders.weight)},
          {"slider_height", fmt::format("{:.6f}", sliders.height)},
          {"slider_proportions", fmt::format("{:.6f}", sliders.proportions)}};
}

}  // namespace

Result<BodyModel> build_human(const MakeHumanData& data, const Phenotype& phenotype) {
  check(phenotype.age_years >= 18 && phenotype.age_years <= 90, "build_human: age {}", phenotype.age_years);
  check(phenotype.sex >= 0 && phenotype.sex <= 1, "build_human: sex {}", phenotype.sex);
  const double muscle = phenotype.muscle.value_or(0.5);
  check(muscle >= 0 && muscle <= 1, "build_human: muscle {}", muscle);
  const MakeHumanAssets& assets = data.impl_->assets;
  const Result<Sliders> sliders = solve_sliders(assets, phenotype);
  if (!sliders) return sliders.failure();
  const std::vector<Eigen::Vector3f> shape = shape_vertices(assets, *sliders);
  const RestPose rest(assets.base, shape);
  Sliders average_build = *sliders;
  average_build.weight = average_build.muscle = 0.5;
  const RestPose average(assets.base, shape_vertices(assets, average_build));

  const std::array<Eigen::Vector3d, 20> rest_joints = joint_centres(assets.base, rest.vertices(), average.vertices());
  const std::array<Eigen::Matrix3d, 20> rotations = zero_from_rest(rest, rest_joints);
  std::array<Eigen::Vector3d, 20> zero_joints = rest_joints;
  const Skeleton parents = human_skeleton(rest_joints);
  std::vector<Rigid3> joint_from_rest(20);
  for (int j = 0; j < 20; ++j) {
    if (const int parent = parents.joints()[j].parent_idx; parent >= 0) {
      zero_joints[j] = zero_joints[parent] + rotations[parent] * (rest_joints[j] - rest_joints[parent]);
    }
    joint_from_rest[j] = {rotations[j], -(rotations[j] * rest_joints[j])};
  }

  BodyModel body{.name = "",
                 .skeleton = human_skeleton(zero_joints),
                 .rest = {},
                 .skin = assets.skin,
                 .joint_from_rest = std::move(joint_from_rest),
                 .end_points = {},
                 .height_m = stature_m(shape),
                 .weight_kg = mass_kg(shape, assets.base.body_faces),
                 .facts = {}};
  body.profile = human_profile(body.skeleton);
  const auto add_end_point = [&](const char* name, int joint, const std::string& cube) {
    body.end_points.push_back({name, joint, body.joint_from_rest[joint] * rest.centre(cube)});
  };
  add_end_point("head_top", kHead, "joint-head-2");
  add_end_point("right_toe_tip", kFoot, "joint-r-toe-1-3");
  add_end_point("left_toe_tip", kFoot + kToLeft, "joint-l-toe-1-3");
  add_end_point("right_finger_tip", kHand, "joint-r-finger-3-4");
  add_end_point("left_finger_tip", kHand + kToLeft, "joint-l-finger-3-4");

  body.rest.faces = assets.base.body_faces;
  for (size_t v = 0; v < kNumBodyVertices; ++v) body.rest.vertices.push_back(rest.vertices()[v].cast<float>());
  body.name = fmt::format("human:age={:g},sex={},height={:.3f},weight={:.1f}", phenotype.age_years,
                          text_of_sex(phenotype.sex), body.height_m, body.weight_kg);
  if (phenotype.muscle) body.name += fmt::format(",muscle={:g}", *phenotype.muscle);
  body.facts = facts_of(assets, *sliders);
  return body;
}

bool has_present_joint_places(const BodyModel& human) {
  const auto fact = human.facts.find(kJointPlacesFact);
  return fact != human.facts.end() && fact->second == kJointPlaces;
}

}  // namespace silpose
