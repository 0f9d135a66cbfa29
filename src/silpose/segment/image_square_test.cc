#include "silpose/segment/image_square.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "silpose/image/mask.h"

namespace silpose {
namespace {

constexpr double kQuarterTurn = std::numbers::pi / 2;

TEST(ImageSquare, PointsAndTurns) {
  const ImageSquare square{100, 50, 20, kQuarterTurn};  // clockwise: its top looks to the right
  const auto top = square.in_image(0.5, 0), left = square.in_image(0, 0.5);
  EXPECT_NEAR(top[0], 110, 1e-9);
  EXPECT_NEAR(top[1], 50, 1e-9);
  EXPECT_NEAR(left[0], 100, 1e-9);
  EXPECT_NEAR(left[1], 40, 1e-9);
  const ImageSquare around = square_around(100, 50, 108, 50);
  EXPECT_NEAR(around.side, 20, 1e-9);
  EXPECT_NEAR(around.turn_rad, kQuarterTurn, 1e-9);
}

ByteImage numbered_image(int width, int height) {
  ByteImage image(width, height, 3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      image.at(x, y, 0) = static_cast<uint8_t>(x);
      image.at(x, y, 1) = static_cast<uint8_t>(y);
      image.at(x, y, 2) = 200;
    }
  }
  return image;
}

TEST(SampleSquare, OfItsOwnSizeIsTheImageInRedGreenBlue) {
  const std::vector<float> values = sample_square(numbered_image(60, 50), {14, 24, 8, 0}, 8);
  for (int y = 0; y < 8; ++y) {
    for (int x = 0; x < 8; ++x) {
      const float* at = &values[static_cast<size_t>(3 * (8 * y + x))];
      EXPECT_NEAR(at[0], 200 / 255.0, 1e-6);
      EXPECT_NEAR(at[1], (20 + y) / 255.0, 1e-6);
      EXPECT_NEAR(at[2], (10 + x) / 255.0, 1e-6);
    }
  }
}

TEST(SampleSquare, TurnedShrunkAndOutside) {
  // Upper row of a square turned clockwise by a quarter: down along its right side.
  const std::vector<float> turned = sample_square(numbered_image(60, 50), {14, 24, 8, kQuarterTurn}, 8);
  EXPECT_NEAR(turned[1] * 255, 20, 0.6);
  EXPECT_NEAR(turned[2] * 255, 17, 0.6);
  EXPECT_NEAR(turned[3 * 7 + 1] * 255, 27, 0.6);
  // A quarter as large: the mean of what each new pixel covers.
  const std::vector<float> shrunk = sample_square(numbered_image(60, 50), {16, 16, 32, 0}, 8);
  EXPECT_NEAR(shrunk[3 * (8 * 3 + 2) + 2] * 255, 9.5, 0.6);
  EXPECT_NEAR(shrunk[3 * (8 * 3 + 2) + 1] * 255, 13.5, 0.6);
  for (const float value : sample_square(numbered_image(60, 50), {500, 24, 8, 0}, 8)) EXPECT_EQ(value, 0);
  EXPECT_THROW((void)sample_square(numbered_image(6, 5), {3, 3, 0, 0}, 8), std::invalid_argument);
}

// Stripes of one pixel become grey where they are finer than the new pixels.
TEST(SampleSquare, DoesNotAlias) {
  ByteImage stripes(300, 300, 3);
  for (int y = 0; y < 300; ++y) {
    for (int x = 0; x < 300; x += 2) {
      for (int c = 0; c < 3; ++c) stripes.at(x, y, c) = 255;
    }
  }
  for (const double side : {110.0, 170.0, 270.0}) {
    const std::vector<float> values = sample_square(stripes, {150, 150, side, 0.1}, 60);
    double squares = 0;
    for (const float value : values) squares += (value - 0.5) * (value - 0.5);
    EXPECT_LT(std::sqrt(squares / static_cast<double>(values.size())), 0.13) << side;
  }
}

// A disc drawn in the square is found where it lies in the image, its edge finer than the square's pixels.
TEST(ValuesInImage, PutsADiscBackInItsPlace) {
  constexpr int kSize = 64;
  const ImageSquare square{200, 150, 320, 0.4};
  const auto middle = square.in_image(0.7, 0.4);
  std::vector<float> values;
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      values.push_back(static_cast<float>(8 - std::hypot(x + 0.5 - 0.7 * kSize, y + 0.5 - 0.4 * kSize)));
    }
  }
  const Image<float> found = values_in_image(values, kSize, square, 400, 300, -10);
  Mask mask(400, 300), disc(400, 300);
  for (int y = 0; y < 300; ++y) {
    for (int x = 0; x < 400; ++x) {
      if (found.at(x, y) > 0) mask.set(x, y);
      if (std::hypot(x + 0.5 - middle[0], y + 0.5 - middle[1]) < 40) disc.set(x, y);
    }
  }
  EXPECT_GT(intersection_over_union(mask, disc), 0.985);
  EXPECT_EQ(values_in_image(values, kSize, {-900, 0, 320, 0}, 400, 300, -10), Image<float>(400, 300, 1, -10));
}

}  // namespace
}  // namespace silpose
