#include "silpose/render/shaded.h"

#include <gtest/gtest.h>

#include <stdexcept>

#include "silpose/body/test_body.h"
#include "silpose/render/draw_overlay.h"
#include "silpose/render/silhouette.h"

namespace silpose {
namespace {

class ShadedTest : public testing::Test {
 protected:
  BodyModel body_ = make_test_body();
  PinholeCamera camera_ = look_at_camera(160, 120, 150, {0.5, 1.2, 3}, {0, 0.6, 0});
  std::vector<double> pose_ = {0.1, 0.5, -0.2, 0.4, 0.3, 0.2, -0.4, 0.5};
  std::vector<Eigen::Vector3f> vertices_ = skin_vertices(body_, pose_);
  Mask mask_ = render_silhouette(body_, camera_, pose_);
  std::vector<Eigen::Vector3f> grey_ = std::vector(vertices_.size(), Eigen::Vector3f(0.5f, 0.5f, 0.5f));

  static double brightness(const ByteImage& image, int x, int y) {
    return (image.at(x, y, 0) + image.at(x, y, 1) + image.at(x, y, 2)) / 3.0;
  }
};

TEST_F(ShadedTest, DepthIsThereWhereTheSilhouetteIs) {
  const Image<float> depth = draw_depth(camera_, vertices_, body_.rest.faces);
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      ASSERT_EQ(depth.at(x, y) != 0, mask_.get(x, y));
      if (mask_.get(x, y)) {
        ASSERT_GT(depth.at(x, y), 2);
        ASSERT_LT(depth.at(x, y), 4);
      }
    }
  }
}

TEST_F(ShadedTest, DepthOfATiltedPlaneIsExact) {
  // The floor in front of a camera that looks down at it; depth along the axis follows from the ray's slope.
  const std::vector<Eigen::Vector3f> floor = {{-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1}};
  const Image<float> depth = draw_depth(camera_, floor, std::vector<Face>{{0, 1, 2}, {0, 2, 3}});
  int seen = 0;
  for (int y = 0; y < 120; y += 7) {
    for (int x = 0; x < 160; x += 7) {
      if (depth.at(x, y) == 0) continue;
      const Eigen::Vector3d ray =
          camera_.cam_from_world.rotation.transpose() * camera_.ray_from_pixel({x + 0.5, y + 0.5});
      EXPECT_NEAR(depth.at(x, y), -camera_.centre_in_world().y() / ray.y(), 2e-3);
      ++seen;
    }
  }
  EXPECT_GT(seen, 20);
}

TEST_F(ShadedTest, NearerSurfacesHideFartherOnes) {
  const std::vector<Eigen::Vector3f> two = {{-1, 0, 1}, {1, 0, 1}, {0, 2, 1}, {-1, 0, 0}, {1, 0, 0}, {0, 2, 0}};
  const PinholeCamera level = look_at_camera(64, 64, 60, {0, 0.7, 4}, {0, 0.7, 0});
  for (const auto& faces : {std::vector<Face>{{0, 1, 2}, {3, 4, 5}}, std::vector<Face>{{3, 4, 5}, {0, 1, 2}}}) {
    EXPECT_NEAR(draw_depth(level, two, faces).at(32, 32), 3, 1e-4);
    std::vector<Eigen::Vector3f> colours(6, {1, 0, 0});
    std::fill(colours.begin() + 3, colours.end(), Eigen::Vector3f(0, 0, 1));
    ByteImage image(64, 64, 3);
    draw_shaded(level, two, faces, colours, {.to_light = {0, 0, 1}, .ambient = 0}, image);
    EXPECT_EQ(image.at(32, 32, 0), 255);
    EXPECT_EQ(image.at(32, 32, 2), 0);
  }
}

TEST_F(ShadedTest, LeavesTheBackgroundAndSmoothsEdges) {
  ByteImage image(160, 120, 3, 200);
  draw_shaded(camera_, vertices_, body_.rest.faces, grey_, {.ambient = 0.2}, image);
  int smooth = 0;
  for (int y = 1; y < 119; ++y) {
    for (int x = 1; x < 159; ++x) {
      int inside = 0;
      for (int k = 0; k < 9; ++k) inside += mask_.get(x + k % 3 - 1, y + k / 3 - 1);
      if (inside == 0) {
        EXPECT_EQ(brightness(image, x, y), 200);
      }
      if (inside == 9) {
        EXPECT_LE(brightness(image, x, y), 128);
      }
      smooth += brightness(image, x, y) > 130 && brightness(image, x, y) < 199;
    }
  }
  EXPECT_GT(smooth, 30);
}

TEST_F(ShadedTest, SidesTowardsTheLightAreBrighter) {
  ByteImage from_left(160, 120, 3), from_right(160, 120, 3);
  draw_shaded(camera_, vertices_, body_.rest.faces, grey_, {.to_light = {-3, 0.2, 1}, .ambient = 0.1}, from_left);
  draw_shaded(camera_, vertices_, body_.rest.faces, grey_, {.to_light = {3, 0.2, 1}, .ambient = 0.1}, from_right);
  const Box box = mask_.bounding_box();
  const int y = box.y + 3 * box.height / 4;
  int x0 = 0, x1 = 159;
  while (!mask_.get(x0, y)) ++x0;
  while (!mask_.get(x1, y)) --x1;
  EXPECT_GT(brightness(from_left, x0 + 1, y), brightness(from_right, x0 + 1, y));
  EXPECT_LT(brightness(from_left, x1 - 1, y), brightness(from_right, x1 - 1, y));
}

TEST_F(ShadedTest, ShadowDarkensTheFloorAwayFromTheLight) {
  ByteImage plain(160, 120, 3, 200), shaded(160, 120, 3, 200);
  const Lighting light{.to_light = {-2, 1.5, 0}, .ambient = 0.3};
  Lighting with_shadow = light;
  with_shadow.shadow = 0.5;
  draw_shaded(camera_, vertices_, body_.rest.faces, grey_, light, plain);
  draw_shaded(camera_, vertices_, body_.rest.faces, grey_, with_shadow, shaded);
  int darker = 0;
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 160; ++x) {
      if (plain.at(x, y) == 200 && shaded.at(x, y) == 100) ++darker;
      if (mask_.get(x, y)) {
        EXPECT_NEAR(plain.at(x, y), shaded.at(x, y), 60);
      }
    }
  }
  EXPECT_GT(darker, 100);
  const auto on_floor = camera_.project({0.7, 0, -0.2});  // right of the body, behind it as the light sees it
  EXPECT_EQ(shaded.at(static_cast<int>(on_floor->x()), static_cast<int>(on_floor->y())), 100);
}

TEST_F(ShadedTest, RefusesOtherSizes) {
  ByteImage small(10, 10, 3);
  EXPECT_THROW(draw_shaded(camera_, vertices_, body_.rest.faces, grey_, {}, small), std::invalid_argument);
  EXPECT_THROW(draw_outline(small, mask_), std::invalid_argument);
}

TEST_F(ShadedTest, OverlayFollowsOutlineAndBones) {
  ByteImage outline(160, 120, 3);
  draw_outline(outline, mask_);
  const ByteImage untouched(160, 120, 3);
  for (int y = 2; y < 118; ++y) {
    for (int x = 2; x < 158; ++x) {
      int inside = 0;
      for (int k = 0; k < 25; ++k) inside += mask_.get(x + k % 5 - 2, y + k / 5 - 2);
      if (inside == 0 || inside == 25) {
        EXPECT_EQ(outline.at(x, y, 1), 0) << x << ' ' << y;
      }
      if (mask_.get(x, y) && !mask_.get(x - 1, y)) {
        EXPECT_GT(outline.at(x, y, 1), 100);
      }
    }
  }
  ByteImage bones(160, 120, 3);
  draw_bones(bones, body_, camera_, pose_);
  const auto landmarks = landmark_positions(body_, pose_);
  const auto middle = camera_.project((landmarks[1] + landmarks[2]) / 2);
  EXPECT_GT(brightness(bones, static_cast<int>(middle->x()), static_cast<int>(middle->y())), 120);
  ByteImage both(160, 120, 3);
  draw_outline(both, render_silhouette(body_, camera_, pose_));
  draw_bones(both, body_, camera_, pose_);
  EXPECT_NE(both, outline);
  EXPECT_NE(both, bones);
}

}  // namespace
}  // namespace silpose
