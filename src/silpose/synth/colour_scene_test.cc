#include "silpose/synth/colour_scene.h"

#include <gtest/gtest.h>

#include <cmath>

#include "silpose/base/parallel.h"
#include "silpose/synth/test_scene.h"

namespace silpose {
namespace {

double mean_difference(const ByteImage& a, const ByteImage& b) {
  double sum = 0;
  for (size_t i = 0; i < a.pixels().size(); ++i) sum += std::abs(a.pixels()[i] - b.pixels()[i]);
  return sum / static_cast<double>(a.pixels().size());
}

TEST(Backdrop, IsKnownByName) {
  EXPECT_EQ(parse_backdrop("textured").value(), Backdrop::kTextured);
  EXPECT_EQ(parse_backdrop("green").value(), Backdrop::kGreen);
  EXPECT_EQ(parse_backdrop("blue").error().message, "backdrop 'blue': textured or green");
}

TEST(Backdrop, FollowsTheSeedAndHasTexture) {
  const PinholeCamera camera = look_at_camera(160, 120, 200, {0, 1, 5}, {0, 1, 0});
  const ByteImage one = draw_backdrop(camera, Backdrop::kTextured, 8, 1);
  EXPECT_EQ(one, draw_backdrop(camera, Backdrop::kTextured, 8, 1));
  EXPECT_GT(mean_difference(one, draw_backdrop(camera, Backdrop::kTextured, 8, 2)), 5);
  double sum = 0, squares = 0;
  for (const uint8_t value : one.pixels()) sum += value, squares += value * value;
  const double mean = sum / 57600, sd = std::sqrt(squares / 57600 - mean * mean);
  EXPECT_GT(sd, 20);
  const ByteImage green = draw_backdrop(camera, Backdrop::kGreen, 8, 1);
  for (const auto& [x, y] : {std::pair{5, 5}, {80, 60}, {150, 115}}) {
    EXPECT_GT(green.at(x, y, 1), 1.8 * green.at(x, y, 0));
    EXPECT_GT(green.at(x, y, 1), 1.8 * green.at(x, y, 2));
  }
}

TEST(ColourScene, ShowsTheBodyWhereTheMaskIs) {
  const SyntheticSequence sequence = make_test_scene(6, 2);
  const ColourScene scene(sequence, 0, {.noise_sd = 0, .shadow = 0});
  EXPECT_EQ(scene.draw(0), scene.backdrop());
  const ByteImage image = scene.draw(4);
  const Mask mask = true_mask(sequence, 0, 4);
  int64_t inside = 0, outside = 0;
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      bool differs = false;
      for (int c = 0; c < 3; ++c) differs |= std::abs(image.at(x, y, c) - scene.backdrop().at(x, y, c)) > 8;
      (mask.get(x, y) ? inside : outside) += differs;
    }
  }
  EXPECT_GT(static_cast<double>(inside), 0.85 * static_cast<double>(mask.count()));
  EXPECT_LT(outside, 150);  // pixels that the outline crosses
}

TEST(ColourScene, CastsAShadowOnTheFloor) {
  const SyntheticSequence sequence = make_test_scene();
  const ByteImage lit = ColourScene(sequence, 0, {.noise_sd = 0, .shadow = 0}).draw(0);
  const ByteImage shaded = ColourScene(sequence, 0, {.noise_sd = 0, .shadow = 0.5}).draw(0);
  int64_t darker = 0;
  for (size_t i = 0; i < lit.pixels().size(); ++i) {
    EXPECT_LE(shaded.pixels()[i], lit.pixels()[i]);
    darker += shaded.pixels()[i] < lit.pixels()[i];
  }
  EXPECT_GT(darker, 100);
}

TEST(ColourScene, NoiseDiffersByFrameButNotByThreads) {
  const SyntheticSequence sequence = make_test_scene(4, 2);
  const ColourScene scene(sequence, 0, {.noise_sd = 3});
  EXPECT_NE(scene.draw(0), scene.draw(1));
  EXPECT_NEAR(mean_difference(scene.draw(0), scene.backdrop()), 3 * std::sqrt(2 / kPi), 0.3);
  const ByteImage many = scene.draw(3);
  const ThreadLimit one(1);
  EXPECT_EQ(scene.draw(3), many);
}

}  // namespace
}  // namespace silpose
