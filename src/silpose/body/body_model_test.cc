#include "silpose/body/body_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "silpose/base/rng.h"
#include "silpose/body/test_body.h"

namespace silpose {
namespace {

// Linear blend skinning as the formula says it.
std::vector<Eigen::Vector3d> skin_plainly(const BodyModel& body, const std::vector<double>& pose) {
  const std::vector<Rigid3> world_from_joint = body.skeleton.forward_kinematics(pose);
  std::vector<Eigen::Vector3d> out;
  for (size_t v = 0; v < body.rest.vertices.size(); ++v) {
    Eigen::Vector3d x = Eigen::Vector3d::Zero();
    for (uint32_t i = body.skin.row_start[v]; i < body.skin.row_start[v + 1]; ++i) {
      const int j = body.skin.joint_idx[i];
      x += body.skin.weight[i] *
           (world_from_joint[j] * (body.joint_from_rest[j] * body.rest.vertices[v].cast<double>()));
    }
    out.push_back(x);
  }
  return out;
}

TEST(TestBody, IsClosedAndWeighed) {
  const BodyModel body = make_test_body();
  EXPECT_TRUE(is_closed(body.rest.faces));
  EXPECT_EQ(body.rest.faces.size(), 68u);
  EXPECT_NEAR(volume(body.rest) * 980, body.weight_kg, 1e-3);
}

TEST(SkinVertices, StandsAsItRests) {
  const BodyModel body = make_test_body();
  const std::vector<double> pose = standing_pose(body);
  EXPECT_NEAR(pose[1], 0.5, 1e-6);
  const std::vector<Eigen::Vector3f> vertices = skin_vertices(body, pose);
  for (size_t v = 0; v < vertices.size(); ++v) EXPECT_LT((vertices[v] - body.rest.vertices[v]).norm(), 1e-6f);
}

TEST(SkinVertices, AgreesWithTheFormula) {
  const BodyModel body = make_test_body();
  Rng rng(1);
  for (int trial = 0; trial < 20; ++trial) {
    std::vector<double> pose(8);
    for (double& value : pose) value = rng.uniform(-1, 1);
    const std::vector<Eigen::Vector3f> vertices = skin_vertices(body, pose);
    const std::vector<Eigen::Vector3d> expected = skin_plainly(body, pose);
    for (size_t v = 0; v < vertices.size(); ++v) EXPECT_LT((vertices[v].cast<double>() - expected[v]).norm(), 1e-5);
  }
}

TEST(SkinVertices, BendsTheTopForward) {
  const BodyModel body = make_test_body();
  std::vector<double> pose = standing_pose(body);
  pose[4] = to_radians(90);  // middle_rx at y 0.7: the top face, 0.8 above, goes to z = 0.8
  const std::vector<Eigen::Vector3f> vertices = skin_vertices(body, pose);
  for (size_t v = 32; v < 36; ++v) EXPECT_NEAR(vertices[v].z(), 0.8, 1e-5);
  const std::vector<Eigen::Vector3d> landmarks = landmark_positions(body, pose);
  EXPECT_THAT(landmark_names(body), testing::ElementsAre("root", "middle", "tip", "tip_end"));
  EXPECT_LT((landmarks[3] - Eigen::Vector3d(0, 0.7, 0.8)).norm(), 1e-9);
}

TEST(SkinVertices, RefusesWrongSizes) {
  const BodyModel body = make_test_body();
  const std::vector<double> pose(8);
  std::vector<Rigid3> scratch(3);
  std::vector<Eigen::Vector3f> vertices(5);
  EXPECT_THROW(skin_vertices(body, pose, scratch, vertices), std::invalid_argument);
  EXPECT_THROW((void)skin_vertices(body, std::vector<double>(7)), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
