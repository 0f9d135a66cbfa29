#include "silpose/render/draw_floor.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <stdexcept>

#include "silpose/body/test_body.h"

namespace silpose {
namespace {

constexpr uint8_t kGrey = 128;

class DrawFloorTest : public testing::Test {
 protected:
  // Whether anything was drawn at a pixel or next to it.
  [[nodiscard]] bool is_drawn(const Eigen::Vector2d& pixel) const {
    for (int y = int(pixel.y()) - 1; y <= int(pixel.y()) + 1; ++y) {
      for (int x = int(pixel.x()) - 1; x <= int(pixel.x()) + 1; ++x) {
        for (int c = 0; c < 3; ++c) {
          if (image_.at(x, y, c) != kGrey) return true;
        }
      }
    }
    return false;
  }
  [[nodiscard]] bool is_drawn(const Eigen::Vector3d& point) const { return is_drawn(*camera_.project(point)); }

  PinholeCamera camera_ = look_at_camera(640, 480, 500, {0.3, 1.5, 4}, {0, 0.3, 0});
  ByteImage image_{640, 480, 3, kGrey};
};

TEST_F(DrawFloorTest, LinesGoThroughWholeMetresAndNothingBetween) {
  camera_.distortion = {-0.2, 0.05, 0.001, -0.001, 0};
  draw_floor(image_, camera_, {0.2, -0.4}, {});
  for (int x = -1; x <= 1; ++x) {
    for (int z = -2; z <= 0; ++z) {
      EXPECT_TRUE(is_drawn(Eigen::Vector3d(x, 0, z))) << x << ", " << z;
      EXPECT_TRUE(is_drawn(Eigen::Vector3d(x + 0.5, 0, z))) << x << " + 0.5, " << z;
      EXPECT_TRUE(is_drawn(Eigen::Vector3d(x, 0, z - 0.5))) << x << ", " << z << " - 0.5";
      EXPECT_FALSE(is_drawn(Eigen::Vector3d(x + 0.5, 0, z - 0.5))) << x << ", " << z << ": the middle of a square";
    }
  }
  EXPECT_FALSE(is_drawn(Eigen::Vector3d(0, 0, -3.5))) << "further than the grid reaches";
}

TEST_F(DrawFloorTest, AxesAreRedGreenAndBlue) {
  draw_floor(image_, camera_, {0, 0}, {});
  const Eigen::Vector2d x = *camera_.project({0.5, 0, 0}), y = *camera_.project({0, 0.5, 0}),
                        z = *camera_.project({0, 0, 0.5});
  EXPECT_GT(image_.at(int(x.x()), int(x.y()), 2), 200);
  EXPECT_GT(image_.at(int(y.x()), int(y.y()), 1), 200);
  EXPECT_GT(image_.at(int(z.x()), int(z.y()), 0), 200);
}

TEST_F(DrawFloorTest, ACameraAmidTheGridSeesNothingOfWhatIsBehindIt) {
  // Looking up: the horizon is below the image, and so is all of the floor. A line that wraps round would be seen.
  camera_ = look_at_camera(640, 480, 500, {0.3, 1.5, 0.3}, {0, 2.5, -1});
  draw_floor(image_, camera_, {0, 0}, {});
  EXPECT_EQ(image_, ByteImage(640, 480, 3, kGrey));
}

TEST_F(DrawFloorTest, TheBodyHidesTheFloorBehindIt) {
  Mask body(640, 480);
  for (int y = 100; y < 300; ++y) {
    for (int x = 250; x < 350; ++x) body.set(x, y);
  }
  draw_floor(image_, camera_, {0, 0}, body);
  for (int y = 100; y < 300; ++y) {
    for (int x = 250; x < 350; ++x) ASSERT_EQ(image_.at(x, y, 0), kGrey);
  }
  EXPECT_TRUE(is_drawn(Eigen::Vector3d(1, 0, 0)));
}

TEST_F(DrawFloorTest, AFootprintIsBelowItsFootAndAsLong) {
  const BodyModel human = load_body(std::filesystem::path(SILPOSE_DATA_DIR) / "human.body").value();
  std::vector<double> pose = standing_pose(human);
  const auto standing = footprints(human, pose);
  ASSERT_EQ(standing.size(), 2);
  EXPECT_EQ(human.skeleton.joints()[static_cast<size_t>(standing[0].joint_idx)].name, "right_foot");
  EXPECT_NEAR(standing[0].lowest.y(), 0, 0.01);
  const std::vector<Eigen::Vector3d> landmarks = landmark_positions(human, pose);
  for (const Footprint& print : standing) {
    Eigen::Array2d least = Eigen::Array2d::Constant(9), most = -least;
    for (const Eigen::Vector2d& corner : print.outline)
      least = least.min(corner.array()), most = most.max(corner.array());
    EXPECT_NEAR(most.y() - least.y(), 0.26, 0.06) << "length";
    EXPECT_NEAR(most.x() - least.x(), 0.11, 0.05) << "width";
    const Eigen::Vector3d& ankle = landmarks[static_cast<size_t>(print.joint_idx)];
    EXPECT_TRUE(ankle.x() > least.x() && ankle.x() < most.x() && ankle.z() > least.y() && ankle.z() < most.y());
  }
  pose[static_cast<size_t>(*human.skeleton.find_dof("root_ty_m"))] += 0.3;
  EXPECT_NEAR(footprints(human, pose)[1].lowest.y(), standing[1].lowest.y() + 0.3, 1e-5);
  draw_footprints(image_, human, camera_, pose);
  EXPECT_TRUE(is_drawn(Eigen::Vector3d(standing[0].outline[0].x(), 0, standing[0].outline[0].y())));
}

TEST_F(DrawFloorTest, ABodyWithoutFeetHasNoFootprints) {
  const BodyModel body = make_test_body();
  EXPECT_TRUE(footprints(body, standing_pose(body)).empty());
}

TEST_F(DrawFloorTest, AnotherImageIsTheCallersMistake) {
  ByteImage small(64, 48, 3);
  EXPECT_THROW(draw_floor(small, camera_, {0, 0}, {}), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
