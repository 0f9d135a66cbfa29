#include "silpose/shape/distance.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace silpose {
namespace {

TEST(PixelCount, CountsWhatDiffers) {
  const Mask a = mask_from_text("##..\n##..");
  const Mask b = mask_from_text(".##.\n.#..");
  EXPECT_EQ(pixel_count_distance(a, b), 3);
  EXPECT_DOUBLE_EQ(pixel_count_fraction(a, b), 3.0 / 7.0);
  EXPECT_EQ(pixel_count_distance(a, a), 0);
  EXPECT_EQ(pixel_count_fraction(a, a), 0);
}

TEST(PixelCount, FractionSpansZeroToOne) {
  EXPECT_EQ(pixel_count_fraction(mask_from_text("##.."), mask_from_text("..##")), 1);
  EXPECT_EQ(pixel_count_fraction(mask_from_text("##.."), Mask(4, 1)), 1);
  EXPECT_EQ(pixel_count_fraction(Mask(4, 1), Mask(4, 1)), 0);
  EXPECT_EQ(pixel_count_fraction(10, 10, 10), 0);
}

TEST(PixelCount, RefusesOtherSizes) {
  EXPECT_THROW((void)pixel_count_distance(Mask(2, 2), Mask(2, 3)), std::invalid_argument);
}

TEST(DepthSsd, SquaresDifferencesAndCountsWhatIsMissing) {
  Image<float> a(3, 2), b(3, 2);
  a.at(0, 0) = 2.0f, b.at(0, 0) = 2.5f;
  a.at(1, 0) = 3.0f, b.at(1, 0) = 3.0f;
  a.at(2, 1) = 4.0f;
  b.at(0, 1) = 1.0f;
  EXPECT_DOUBLE_EQ(depth_ssd(a, b, 0.3), 0.25 + 2 * 0.09);
  EXPECT_DOUBLE_EQ(depth_ssd(a, a, 0.3), 0);
  EXPECT_THROW((void)depth_ssd(a, Image<float>(2, 3), 1), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
