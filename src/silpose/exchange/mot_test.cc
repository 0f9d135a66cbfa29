#include "silpose/exchange/mot.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <sstream>

#include "silpose/base/rng.h"
#include "silpose/base/text_file.h"
#include "silpose/body/test_body.h"
#include "silpose/human/human.h"

namespace silpose {
namespace {

using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Coordinates = std::map<std::string, double>;

Skeleton human() {
  return human_skeleton(std::vector<Vector3d>{{0, 0.95, 0},      {0, 1.05, -0.02},  {0, 1.2, -0.02}, {0, 1.5, 0},
                                              {-0.1, 0.9, 0.01}, {-0.1, 0.9, 0.01}, {-0.1, 0.5, 0},  {-0.1, 0.08, 0},
                                              {0.1, 0.9, 0.01},  {0.1, 0.9, 0.01},  {0.1, 0.5, 0},   {0.1, 0.08, 0},
                                              {-0.02, 1.42, 0},  {-0.18, 1.4, 0},   {-0.18, 1.1, 0}, {-0.18, 0.85, 0},
                                              {0.02, 1.42, 0},   {0.18, 1.4, 0},    {0.18, 1.1, 0},  {0.18, 0.85, 0}});
}

class Mot : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(path_); }

  // What a .mot of these poses holds, row by row.
  std::vector<Coordinates> written(const std::vector<std::vector<double>>& poses) {
    PoseTable table;
    for (const auto& pose : poses) {
      const auto frame = static_cast<int64_t>(table.rows.size());
      table.rows.push_back({frame, 0.1 * static_cast<double>(frame), pose});
    }
    EXPECT_TRUE(write_mot(path_, skeleton_, table).ok());
    std::istringstream text(read_text_file(path_).value());
    std::string line;
    while (std::getline(text, line) && line != "endheader") header_.push_back(line);
    std::getline(text, line);
    std::istringstream names_of(line);
    std::vector<std::string> names;
    for (std::string name; names_of >> name;) names.push_back(name);
    std::vector<Coordinates> rows;
    while (std::getline(text, line)) {
      std::istringstream values(line);
      Coordinates row;
      for (const std::string& name : names) EXPECT_TRUE(values >> row[name]) << name;
      rows.push_back(row);
    }
    return rows;
  }

  std::vector<double> pose_with(const std::vector<std::pair<std::string, double>>& dofs_deg) const {
    std::vector<double> pose(static_cast<size_t>(skeleton_.num_dofs()), 0.0);
    for (const auto& [name, degrees] : dofs_deg)
      pose[static_cast<size_t>(skeleton_.find_dof(name).value())] = to_radians(degrees);
    return pose;
  }

  const Skeleton skeleton_ = human();
  const std::filesystem::path path_ = std::filesystem::path(testing::TempDir()) / "motion.mot";
  std::vector<std::string> header_;
};

TEST_F(Mot, TheZeroPoseIsTheModelsFacingZWithPalmsToTheThighs) {
  std::vector<double> pose = pose_with({});
  pose[0] = 1, pose[1] = 0.95, pose[2] = -2;
  const std::vector<Coordinates> rows = written({pose});
  for (const auto& [name, value] : rows[0]) {
    double wanted = 0;
    if (name == "pelvis_rotation") wanted = -90;
    if (name == "pro_sup_r" || name == "pro_sup_l") wanted = 90;
    // Hips at (1, 0.9, -1.99); the model's pelvis origin is 56 mm before and 78 mm above their middle.
    if (name == "pelvis_tx") wanted = 1;
    if (name == "pelvis_ty") wanted = 0.9 + 0.07849;
    if (name == "pelvis_tz") wanted = -1.99 + 0.056276;
    EXPECT_NEAR(value, wanted, 1e-6) << name;
  }
  EXPECT_THAT(header_, testing::ElementsAre("Coordinates", "version=1", "nRows=1", "nColumns=40", "inDegrees=yes",
                                            testing::HasSubstr("Rajagopal2016")));
}

TEST_F(Mot, EachDofMovesItsCoordinateInTheModelsSense) {
  // The subject faces +X, as the model does in its zero pose.
  struct Case {
    const char *dof, *coordinate;
    double sign, offset;
  };
  const std::vector<Case> cases = {{"root_rx", "pelvis_tilt", -1, 0},
                                   {"root_rz", "pelvis_list", 1, 0},
                                   {"thorax_rx", "lumbar_extension", -1, 0},
                                   {"abdomen_rx", "lumbar_extension", -1, 0},
                                   {"thorax_ry", "lumbar_rotation", 1, 0},
                                   {"thorax_rz", "lumbar_bending", 1, 0},
                                   {"right_thigh_rx", "hip_flexion_r", 1, 0},
                                   {"left_thigh_rx", "hip_flexion_l", 1, 0},
                                   {"right_thigh_rz", "hip_adduction_r", -1, 0},
                                   {"left_thigh_rz", "hip_adduction_l", -1, 0},
                                   {"right_thigh_ry", "hip_rotation_r", 1, 0},
                                   {"left_thigh_ry", "hip_rotation_l", 1, 0},
                                   {"right_shin_rx", "knee_angle_r", 1, 0},
                                   {"left_shin_rx", "knee_angle_l_beta", 1, 0},
                                   {"right_foot_rx", "ankle_angle_r", 1, 0},
                                   {"left_foot_rx", "ankle_angle_l", 1, 0},
                                   {"right_upper_arm_rx", "arm_flex_r", 1, 0},
                                   {"left_upper_arm_rx", "arm_flex_l", 1, 0},
                                   {"right_upper_arm_rz", "arm_add_r", -1, 0},
                                   {"left_upper_arm_rz", "arm_add_l", -1, 0},
                                   {"right_upper_arm_ry", "arm_rot_r", 1, 0},
                                   {"left_upper_arm_ry", "arm_rot_l", 1, 0},
                                   {"right_forearm_rx", "elbow_flex_r", 1, 0},
                                   {"left_forearm_rx", "elbow_flex_l", 1, 0},
                                   {"right_forearm_ry", "pro_sup_r", 1, 90},
                                   {"left_forearm_ry", "pro_sup_l", 1, 90},
                                   {"right_hand_rx", "wrist_flex_r", 1, 0},
                                   {"left_hand_rx", "wrist_flex_l", 1, 0},
                                   {"right_hand_rz", "wrist_dev_r", -1, 0},
                                   {"left_hand_rz", "wrist_dev_l", -1, 0}};
  const Coordinates rest = written({pose_with({{"root_ry", 90}})})[0];
  EXPECT_NEAR(rest.at("pelvis_rotation"), 0, 1e-6);
  for (const auto& [dof, coordinate, sign, offset] : cases) {
    const Coordinates moved = written({pose_with({{"root_ry", 90}, {dof, 20}})})[0];
    EXPECT_NEAR(moved.at(coordinate), sign * 20 + offset, 1e-5) << dof;
    for (const auto& [name, value] : moved) {
      if (name.starts_with("pelvis_t") || name.starts_with(coordinate) || name + "_beta" == coordinate) continue;
      EXPECT_NEAR(value, rest.at(name), 1e-5) << dof << " moves " << name;
    }
  }
}

// The model's bodies, turned as its coordinates say, stand as ours do: joint after joint about the model's own axes.
TEST_F(Mot, TheModelTurnsAsOurSkeletonDoes) {
  Rng rng(5);
  std::vector<std::vector<double>> poses;
  for (int i = 0; i < 100; ++i) {
    std::vector<double> pose;
    for (const Dof& dof : skeleton_.dofs()) pose.push_back(rng.uniform(dof.lower, dof.upper));
    poses.push_back(pose);
  }
  const std::vector<Coordinates> rows = written(poses);
  const auto turn = [](double degrees, const Vector3d& axis) {
    return AngleAxisd(to_radians(degrees), axis).toRotationMatrix();
  };
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(), z = Vector3d::UnitZ();
  Matrix3d zero;  // our joints' axes in a body of the model
  zero << 0, 0, 1, 0, 1, 0, -1, 0, 0;
  for (size_t i = 0; i < poses.size(); ++i) {
    const Coordinates& at = rows[i];
    const auto world_from_joint = skeleton_.forward_kinematics(poses[i]);
    const auto expect = [&](const Matrix3d& world_from_body, const std::string& joint, double palm_deg = 0) {
      const Matrix3d ours = world_from_joint[static_cast<size_t>(skeleton_.find_joint(joint).value())].rotation;
      EXPECT_LT((world_from_body * turn(palm_deg, y) * zero - ours).norm(), 1e-6) << joint << " of pose " << i;
    };
    const Matrix3d pelvis =
        turn(at.at("pelvis_tilt"), z) * turn(at.at("pelvis_list"), x) * turn(at.at("pelvis_rotation"), y);
    const Matrix3d torso = pelvis * turn(at.at("lumbar_extension"), z) * turn(at.at("lumbar_bending"), x) *
                           turn(at.at("lumbar_rotation"), y);
    expect(pelvis, "root");
    expect(torso, "thorax");
    for (const auto& [side, end, sign] : {std::tuple{"right_", "_r", 1.0}, std::tuple{"left_", "_l", -1.0}}) {
      const auto value = [&, e = std::string(end)](const std::string& name) { return at.at(name + e); };
      const std::string s = side;
      const Matrix3d femur = pelvis * turn(value("hip_flexion"), z) * turn(sign * value("hip_adduction"), x) *
                             turn(sign * value("hip_rotation"), y);
      const Matrix3d tibia = femur * turn(value("knee_angle"), -z), foot = tibia * turn(value("ankle_angle"), z);
      const Matrix3d humerus =
          torso * turn(value("arm_flex"), z) * turn(sign * value("arm_add"), x) * turn(sign * value("arm_rot"), y);
      const Matrix3d radius = humerus * turn(value("elbow_flex"), z) * turn(sign * value("pro_sup"), y);
      const Matrix3d hand = radius * turn(value("wrist_flex"), z) * turn(sign * value("wrist_dev"), x);
      expect(femur, s + "thigh");
      expect(tibia, s + "shin");
      expect(foot, s + "foot");
      expect(humerus, s + "upper_arm");
      expect(radius, s + "forearm", -sign * 90);
      expect(hand, s + "hand", -sign * 90);
    }
  }
}

TEST_F(Mot, CurvesDoNotJump) {
  std::vector<std::vector<double>> poses;
  for (int frame = 0; frame <= 720; frame += 5) {  // turns round twice while an arm swings up to 170 degrees
    const double up = frame / 720.0 * 170;
    poses.push_back(
        pose_with({{"root_ry", frame}, {"root_rx", 30}, {"right_upper_arm_rx", up}, {"left_upper_arm_rz", up}}));
  }
  const std::vector<Coordinates> rows = written(poses);
  for (size_t i = 1; i < rows.size(); ++i) {
    for (const auto& [name, value] : rows[i])
      EXPECT_LT(std::abs(value - rows[i - 1].at(name)), 20) << name << " row " << i;
  }
  EXPECT_NEAR(rows.back().at("pelvis_rotation") - rows.front().at("pelvis_rotation"), 720, 1e-6);
  EXPECT_NEAR(rows.back().at("arm_flex_r"), 170, 1e-5);
  EXPECT_NEAR(rows.back().at("arm_add_l"), -170, 1e-5);
}

TEST_F(Mot, IsOfTheHumanOnly) {
  EXPECT_TRUE(has_opensim_coordinates(skeleton_));
  const Skeleton tube = make_test_body().skeleton;
  EXPECT_FALSE(has_opensim_coordinates(tube));
  EXPECT_THROW((void)write_mot(path_, tube, {}), std::invalid_argument);
  EXPECT_THAT(write_mot("no/such/place.mot", skeleton_, {}).error().message,
              testing::HasSubstr("no/such/place.mot: cannot be written"));
}

}  // namespace
}  // namespace silpose
