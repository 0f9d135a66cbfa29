#include "silpose/shape/normalised_silhouette.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace silpose {
namespace {

Mask disc(int width, int height, double x, double y, double radius) {
  Mask mask(width, height);
  for (int j = 0; j < height; ++j) {
    for (int i = 0; i < width; ++i) {
      const double dx = i + 0.5 - x, dy = j + 0.5 - y;
      if (dx * dx + dy * dy < radius * radius) mask.set(i, j);
    }
  }
  return mask;
}

TEST(ResampleMask, ScaleOneIsTheMaskItself) {
  const Mask mask = disc(130, 70, 60, 30, 25);
  EXPECT_EQ(resample_mask(mask, window_of_image(130, 70, 1)), mask);
}

TEST(ResampleMask, HalfCoveredPixelsAreSet) {
  const Mask mask = mask_from_text(R"(
    ####.#
    ##...#
    #.....
    .....#)");
  EXPECT_EQ(text_from_mask(resample_mask(mask, window_of_image(6, 4, 0.5))), "###\n...\n");
}

TEST(ResampleCoverage, GivesHowMuchOfEachPixelIsSet) {
  const Mask mask = mask_from_text(R"(
    ####.#
    ##...#
    #.....
    .....#)");
  const ByteImage half = resample_coverage(mask, window_of_image(6, 4, 0.5), 64);
  ASSERT_EQ(half.width(), 3);
  const int expected[2][3] = {{64, 32, 32}, {16, 0, 16}};
  for (int y = 0; y < 2; ++y) {
    for (int x = 0; x < 3; ++x) EXPECT_EQ(half.at(x, y), expected[y][x]) << x << ", " << y;
  }
  const Window shifted{.x0 = -0.25, .y0 = 0, .scale_x = 1, .scale_y = 1, .width = 2, .height = 1};
  EXPECT_EQ(resample_coverage(mask, shifted, 64).at(0, 0), 48);
  EXPECT_EQ(resample_coverage(mask, shifted, 64).at(1, 0), 64);
  EXPECT_THROW((void)resample_coverage(mask, shifted, 256), std::invalid_argument);
}

TEST(ResampleMask, EnlargesByRepeatingPixels) {
  const Mask mask = mask_from_text("#.\n.#");
  EXPECT_EQ(text_from_mask(resample_mask(mask, window_of_image(2, 2, 2))), "##..\n##..\n..##\n..##\n");
}

TEST(ResampleMask, OutsideTheMaskIsEmpty) {
  const Mask mask = mask_from_text("##\n##");
  const Window window{.x0 = -2, .y0 = -1, .width = 5, .height = 4};
  EXPECT_EQ(text_from_mask(resample_mask(mask, window)), ".....\n..##.\n..##.\n.....\n");
  EXPECT_EQ(resample_mask(mask, Window{.x0 = 50, .y0 = 50, .width = 3, .height = 3}).count(), 0);
}

TEST(ResampleMask, KeepsAreaAtFractionalScales) {
  const Mask mask = disc(300, 300, 150, 140, 100);
  for (const double scale : {0.213, 0.4, 0.77, 1.3}) {
    const Mask small = resample_mask(mask, window_of_image(300, 300, scale));
    EXPECT_NEAR(static_cast<double>(small.count()), static_cast<double>(mask.count()) * scale * scale,
                6 * 100 * scale * 0.1)
        << scale;
  }
}

TEST(ResampleMask, RefusesEmptyWindows) {
  EXPECT_THROW((void)resample_mask(Mask(2, 2), Window{}), std::invalid_argument);
  EXPECT_THROW((void)window_of(Box{}, 0, 4), std::invalid_argument);
}

TEST(NormalisedSilhouette, ForgetsPlaceAndSize) {
  const Mask small = normalised_silhouette(disc(200, 200, 50, 60, 30), 64, 64);
  const Mask large = normalised_silhouette(disc(400, 300, 230, 140, 120), 64, 64);
  EXPECT_GT(intersection_over_union(small, large), 0.97);
  EXPECT_EQ(small.bounding_box(), (Box{0, 0, 64, 64}));
}

TEST(NormalisedSilhouette, StretchesEachAxis) {
  EXPECT_EQ(normalised_silhouette(mask_from_text(".....\n.###.\n....."), 6, 6).count(), 36);
}

TEST(NormalisedSilhouette, OfNothingIsNothing) { EXPECT_EQ(normalised_silhouette(Mask(9, 9), 4, 4), Mask(4, 4)); }

}  // namespace
}  // namespace silpose
