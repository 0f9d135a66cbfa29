#include "silpose/recording/mask_strip.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "silpose/image/image_file.h"

namespace silpose {
namespace {

ByteImage decoded(const MaskExample& example) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "silpose_mask_strip.jpg";
  std::ofstream(path, std::ios::binary) << example.jpeg;
  ByteImage image = read_colour_image(path).value();
  std::filesystem::remove(path);
  return image;
}

Mask block(int width, int height, const Box& box) {
  Mask mask(width, height);
  for (int y = box.y; y < box.y + box.height; ++y) {
    for (int x = box.x; x < box.x + box.width; ++x) mask.set(x, y);
  }
  return mask;
}

TEST(MaskStrip, ExamplesLieEvenlyOverTheClip) {
  const ByteImage image(80, 80, 3, 90);
  const Mask mask = block(80, 80, {30, 30, 20, 20});
  for (const int count : {0, 1, 5, 8, 9, 15, 16, 17, 31, 32, 33, 100, 257, 1000}) {
    MaskStrip strip;
    for (int i = 0; i < count; ++i) strip.add(100 + i, 0.1 * i, image, mask);
    const std::vector<MaskExample> examples = strip.examples();
    ASSERT_EQ(examples.size(), std::min<size_t>(8, count)) << count;
    if (count == 0) continue;
    EXPECT_EQ(examples.front().frame_idx, 100);
    for (const MaskExample& example : examples) EXPECT_EQ(decoded(example).width(), 240);
    const double even = count / 8.0;
    for (size_t i = 1; i < examples.size(); ++i) {
      const auto step = static_cast<double>(examples[i].frame_idx - examples[i - 1].frame_idx);
      EXPECT_GE(step, 1) << count;
      EXPECT_LE(step, std::max(2.0, 1.7 * even)) << count;
      EXPECT_NEAR(examples[i].time_s, 0.1 * static_cast<double>(examples[i].frame_idx - 100), 1e-9);
    }
    EXPECT_GE(examples.back().frame_idx, 100 + count - 1 - 1.1 * even) << count;
  }
}

TEST(MaskStrip, ShowsTheMaskNearAndOutlined) {
  MaskStrip strip;
  strip.add(0, 0, ByteImage(640, 480, 3, 90), block(640, 480, {300, 200, 50, 100}));  // 130 x 130 are cut out
  const MaskExample example = strip.examples().at(0);
  EXPECT_FALSE(example.is_empty);
  EXPECT_EQ(example.width, 240);
  EXPECT_EQ(example.height, 240);
  const ByteImage image = decoded(example);
  ASSERT_EQ(image.width(), 240);
  const auto green = [&](int x, int y) { return image.at(x, y, 1) - (image.at(x, y, 0) + image.at(x, y, 2)) / 2; };
  // The mask's left border is 40 of 130 pixels from the left.
  int strongest = 0;
  for (int x = 0; x < 120; ++x) strongest = green(x, 120) > green(strongest, 120) ? x : strongest;
  EXPECT_NEAR(strongest, 240.0 * 40 / 130, 2);
  EXPECT_GT(green(strongest, 120), 60);
  EXPECT_LT(green(120, 120), 20);
  EXPECT_LT(example.jpeg.size(), 20'000u);
}

TEST(MaskStrip, WithoutAMaskTheImageIsWhole) {
  MaskStrip strip;
  strip.add(0, 0, ByteImage(640, 320, 3, 90), Mask(640, 320));
  const MaskExample example = strip.examples().at(0);
  EXPECT_TRUE(example.is_empty);
  EXPECT_EQ(example.width, 240);
  EXPECT_EQ(example.height, 120);
}

TEST(MaskStrip, AMaskThatFillsTheImage) {
  MaskStrip strip;
  strip.add(0, 0, ByteImage(40, 90, 3, 90), block(40, 90, {0, 0, 40, 90}));
  EXPECT_EQ(strip.examples().at(0).height, 240);
  EXPECT_THROW(strip.add(1, 0, ByteImage(41, 90, 3), Mask(40, 90)), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
