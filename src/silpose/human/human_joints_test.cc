// By hand, and on the fetched body data against breadths, heights and lengths that others measured on people.
#include "silpose/human/human_joints.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "silpose/human/human_shape.h"
#include "silpose/human/makehuman_assets.h"

namespace silpose {
namespace {

using Eigen::Vector3d;

const MakeHumanAssets& assets() {
  static const MakeHumanAssets loaded =
      load_makehuman_assets(std::filesystem::path(SILPOSE_DATA_DIR) / "makehuman").value();
  return loaded;
}
const MakeHumanData& data() {
  static const MakeHumanData loaded =
      MakeHumanData::load(std::filesystem::path(SILPOSE_DATA_DIR) / "makehuman").value();
  return loaded;
}

// A person of 1.70 m in its rest pose, metres, floor at y = 0, with its joints.
struct Person {
  std::vector<Vector3d> vertices;
  std::array<Vector3d, 20> joints;
};
Person person(double sex, double weight_slider) {
  const Phenotype phenotype{.age_years = 30, .sex = sex, .height_m = 1.70};
  Sliders average = solve_sliders(assets(), phenotype).value();
  average.weight = average.muscle = 0.5;
  Sliders sliders = average;
  sliders.weight = weight_slider;
  sliders.muscle = 0.5 - std::abs(weight_slider - 0.5);
  const auto in_metres = [](const std::vector<Eigen::Vector3f>& shape) {
    std::vector<Vector3d> out;
    for (const Eigen::Vector3f& x : shape) out.push_back(0.1 * x.cast<double>());
    const Vector3d floor(0, cube_centre(assets().base, out, "joint-ground").y(), 0);
    for (Vector3d& x : out) x -= floor;
    return out;
  };
  Person made{.vertices = in_metres(shape_vertices(assets(), sliders)), .joints = {}};
  made.joints = joint_centres(assets().base, made.vertices, in_metres(shape_vertices(assets(), average)));
  return made;
}

enum { kHipL = 9, kKneeL = 10, kAnkleL = 11, kShoulderL = 17, kElbowL = 18, kWristL = 19, kToRightLimb = -4 };

// How often the skin winds around a point: 1 inside, 0 outside.
double winding_number(const std::vector<Vector3d>& vertices, const Vector3d& x) {
  double angle = 0;
  for (const Face& face : assets().base.body_faces) {
    const Vector3d a = vertices[face[0]] - x, b = vertices[face[1]] - x, c = vertices[face[2]] - x;
    const double la = a.norm(), lb = b.norm(), lc = c.norm();
    angle += 2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return angle / (4 * std::numbers::pi);
}

TEST(HumanJoints, LandmarksOfTheSidesMirrorEachOther) {
  for (int l = 0; l < kNumLandmarks; ++l) {
    const auto right = landmark_vertices(static_cast<Landmark>(l), Side::kRight);
    const auto left = landmark_vertices(static_cast<Landmark>(l), Side::kLeft);
    ASSERT_EQ(right.size(), left.size());
    for (const uint32_t v : left) {
      Eigen::Vector3f mirrored = assets().base.vertices[v];
      EXPECT_GT(mirrored.x(), 0);
      mirrored.x() = -mirrored.x();
      const bool found =
          std::ranges::any_of(right, [&](uint32_t r) { return (assets().base.vertices[r] - mirrored).norm() < 1e-5f; });
      EXPECT_TRUE(found) << "landmark " << l << ", vertex " << v;
    }
  }
}

TEST(HumanJoints, HipsByHand) {
  // Width 0.24, depth 0.15, level: 0.24 x 0.15 + 0.0099 behind, 0.30 x 0.24 + 0.0109 below, 0.33 x 0.24 + 0.0073
  // beside.
  const PelvisSpines level = {.right_front = {-0.12, 1, 0.1},
                              .left_front = {0.12, 1, 0.1},
                              .right_back = {-0.04, 1, -0.05},
                              .left_back = {0.04, 1, -0.05}};
  const HipCentres hips = hip_centres(level);
  EXPECT_TRUE(hips.left.isApprox(Vector3d(0.0865, 0.9171, 0.0541), 1e-9)) << hips.left.transpose();
  EXPECT_TRUE(hips.right.isApprox(Vector3d(-0.0865, 0.9171, 0.0541), 1e-9)) << hips.right.transpose();
  // They turn with the pelvis.
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.4, Vector3d(1, 2, -0.5).normalized()).toRotationMatrix();
  const HipCentres turned = hip_centres({.right_front = turn * level.right_front,
                                         .left_front = turn * level.left_front,
                                         .right_back = turn * level.right_back,
                                         .left_back = turn * level.left_back});
  EXPECT_TRUE(turned.left.isApprox(turn * hips.left, 1e-9));
}

TEST(HumanJoints, ShoulderByHand) {
  // Acromion to elbow 0.2871, to radiale 0.3: 0.0312; to the other acromion 0.38: 0.0646; their mean 0.0479.
  const Vector3d centre = shoulder_centre({0.19, 1.4, 0.02}, {-0.19, 1.4, 0.02}, {0.19, 1.1129, 0.02});
  EXPECT_TRUE(centre.isApprox(Vector3d(0.19, 1.3521, 0.02), 1e-9)) << centre.transpose();
}

TEST(HumanJoints, LandmarksAreWherePeopleHaveThem) {
  for (const double sex : {0.0, 1.0}) {
    const std::vector<Vector3d> vertices = person(sex, 0.5).vertices;
    const auto place = [&](Landmark landmark) { return landmark_place(vertices, landmark, Side::kLeft); };
    // Breadth between the front spines: 224 of 1,770 mm in men, 238 of 1,610 mm in women (dumas2007).
    EXPECT_NEAR(2 * place(Landmark::kFrontSpine).x(), 1.70 * (sex == 0 ? 0.127 : 0.148), 0.033) << sex;
    // A pelvis is inclined by 11 degrees, standard deviation 4 (levine1996).
    const Vector3d back_to_front = place(Landmark::kFrontSpine) - place(Landmark::kBackSpine);
    EXPECT_NEAR(to_degrees(std::atan2(-back_to_front.y(), back_to_front.z())), 11, 6) << sex;
    // Heights over the floor, shares of stature (winter2009): acromion 0.818.
    EXPECT_NEAR(place(Landmark::kAcromion).y(), 0.818 * 1.70, 0.02) << sex;
    // The inner malleolus is higher than the outer.
    EXPECT_GT(place(Landmark::kMedialMalleolus).y(), place(Landmark::kLateralMalleolus).y()) << sex;
  }
}

TEST(HumanJoints, BonesHaveTheLengthsOfPeoples) {
  for (const double sex : {0.0, 1.0}) {
    const std::array<Vector3d, 20> x = person(sex, 0.5).joints;
    const auto length = [&](int a, int b) { return (x[static_cast<size_t>(a)] - x[static_cast<size_t>(b)]).norm(); };
    // Between the same centres, scaled to 1.70 m (dumas2007: men of 1.77 m, women of 1.61 m), to 2 cm.
    const double scale = 1.70 / (sex == 0 ? 1.77 : 1.61);
    EXPECT_NEAR(length(kHipL, kKneeL), scale * (sex == 0 ? 0.432 : 0.379), 0.02) << sex;
    EXPECT_NEAR(length(kKneeL, kAnkleL), scale * (sex == 0 ? 0.433 : 0.388), 0.02) << sex;
    EXPECT_NEAR(length(kShoulderL, kElbowL), scale * (sex == 0 ? 0.271 : 0.243), 0.02) << sex;
    // Shares of stature (winter2009): elbow to wrist 0.146. The women's mesh has short forearms.
    EXPECT_NEAR(length(kElbowL, kWristL), 0.146 * 1.70, 0.022) << sex;
    // Knee over the floor, on a straight leg: 0.285; hip: 0.53.
    EXPECT_NEAR(x[kAnkleL].y() + length(kKneeL, kAnkleL), 0.285 * 1.70, 0.02) << sex;
    EXPECT_NEAR(x[kHipL].y(), 0.53 * 1.70, 0.02) << sex;
  }
}

TEST(HumanJoints, LieInTheFlesh) {
  for (const double sex : {0.0, 1.0}) {
    for (const double weight : {0.1, 0.5, 0.9}) {
      const Person made = person(sex, weight);
      for (const int joint : {+kHipL, +kKneeL, +kAnkleL, +kShoulderL, +kElbowL, +kWristL}) {
        const Vector3d x = made.joints[static_cast<size_t>(joint)];
        EXPECT_NEAR(winding_number(made.vertices, x), 1, 1e-3) << sex << " " << weight << " " << joint;
        double nearest = 1;  // a thin wrist is 3 cm thick
        for (uint32_t v = 0; v < kNumBodyVertices; ++v) nearest = std::min(nearest, (made.vertices[v] - x).norm());
        EXPECT_GT(nearest, 0.013) << sex << " " << weight << " " << joint;
        Vector3d mirrored = made.joints[static_cast<size_t>(joint + kToRightLimb)];
        mirrored.x() = -mirrored.x();
        EXPECT_LT((mirrored - x).norm(), 1e-5);
      }
    }
  }
}

TEST(HumanJoints, FatDoesNotMoveTheHipsInTheirBones) {
  // On the skin alone the hips of the heaviest men would lie 3 cm lower.
  const auto hip_in_rig = [](const Person& who) -> Vector3d {
    return who.joints[kHipL] - cube_centre(assets().base, who.vertices, "joint-l-upper-leg");
  };
  EXPECT_LT((hip_in_rig(person(0, 0.95)) - hip_in_rig(person(0, 0.5))).norm(), 1e-4);
}

TEST(HumanJoints, OfABodyFromAnEarlierVersionAreRecognised) {
  BodyModel body = build_human(data(), {}).value();
  EXPECT_TRUE(has_present_joint_places(body));
  body.facts.erase("joint_places");
  EXPECT_FALSE(has_present_joint_places(body));
  body.facts["joint_places"] = "cubes";
  EXPECT_FALSE(has_present_joint_places(body));
}

}  // namespace
}  // namespace silpose
