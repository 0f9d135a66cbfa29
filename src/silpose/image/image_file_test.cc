#include "silpose/image/image_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "silpose/base/folder_for_test.h"

namespace silpose {
namespace {

namespace fs = std::filesystem;
using testing::EndsWith;
using testing::HasSubstr;

using ImageFileTest = FolderTest;

ByteImage gradient(int width, int height, int channels) {
  ByteImage image(width, height, channels);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < channels; ++c) image.at(x, y, c) = static_cast<uint8_t>(7 * x + 11 * y + 90 * c);
    }
  }
  return image;
}

void truncate(const fs::path& path, double fraction) {
  fs::resize_file(path, static_cast<uintmax_t>(static_cast<double>(fs::file_size(path)) * fraction));
}

TEST_F(ImageFileTest, PngRoundTripIsExactAndKeepsChannelOrder) {
  const ByteImage colour = gradient(17, 9, 3), grey = gradient(17, 9, 1);
  ASSERT_TRUE(write_image(folder_ / "colour.png", colour).ok());
  ASSERT_TRUE(write_image(folder_ / "grey.png", grey).ok());
  EXPECT_EQ(read_colour_image(folder_ / "colour.png").value(), colour);
  EXPECT_EQ(read_grey_image(folder_ / "grey.png").value(), grey);

  const ByteImage repeated = read_colour_image(folder_ / "grey.png").value();
  EXPECT_EQ(repeated.channels(), 3);
  EXPECT_EQ(repeated.at(3, 4, 2), grey.at(3, 4));
}

TEST_F(ImageFileTest, DepthRoundTripKeepsSixteenBitsAndNothingElseIsDepth) {
  DepthImage depth(5, 3);
  for (size_t i = 0; i < 15; ++i) depth.pixels()[i] = static_cast<uint16_t>(4096 * i + 7);
  ASSERT_TRUE(write_depth_image(folder_ / "depth.png", depth).ok());
  EXPECT_EQ(read_depth_image(folder_ / "depth.png").value(), depth);
  ASSERT_TRUE(write_image(folder_ / "grey.png", gradient(5, 3, 1)).ok());
  EXPECT_THAT(read_depth_image(folder_ / "grey.png").error().message,
              HasSubstr("grey.png: 1 channels of 8 bits, depth is one of 16"));
  EXPECT_THAT(read_depth_image(folder_ / "none.png").error().message, HasSubstr("no such file"));
}

TEST_F(ImageFileTest, MaskRoundTrip) {
  const Mask mask = mask_from_text("..#\n##.\n...\n.#.");
  ASSERT_TRUE(write_mask(folder_ / "mask.png", mask).ok());
  EXPECT_EQ(read_mask(folder_ / "mask.png").value(), mask);
}

TEST_F(ImageFileTest, NamesWhatIsWrongWithAFile) {
  EXPECT_THAT(read_mask(folder_ / "none.png").error().message, EndsWith("none.png: no such file"));
  EXPECT_THAT(read_mask(folder_).error().message, EndsWith(": not a file"));
  std::ofstream(folder_ / "empty.png").close();
  EXPECT_THAT(read_colour_image(folder_ / "empty.png").error().message, EndsWith("empty.png: the file is empty"));
  std::ofstream(folder_ / "text.png") << "not at all an image";
  EXPECT_THAT(read_grey_image(folder_ / "text.png").error().message, EndsWith("text.png: not an image"));
}

TEST_F(ImageFileTest, RefusesImagesThatAreCutOff) {
  for (const char* name : {"cut.png", "cut.jpg"}) {
    ASSERT_TRUE(write_image(folder_ / name, gradient(64, 64, 3)).ok());
    ASSERT_TRUE(read_colour_image(folder_ / name).ok());
    for (double keep : {0.9, 0.5, 0.05}) {
      truncate(folder_ / name, keep);
      EXPECT_FALSE(read_colour_image(folder_ / name).ok()) << name << " " << keep;
    }
  }
}

TEST_F(ImageFileTest, RefusesHugeImagesBeforeTheyTakeMemory) {
  for (const char* name : {"huge.png", "huge.jpg"}) {
    write_image(folder_ / name, gradient(64, 64, 3)).value();
    std::ifstream stream(folder_ / name, std::ios::binary);
    std::string bytes((std::istreambuf_iterator<char>(stream)), {});
    const std::string kStart = "\xff\xc0";
    const size_t at = std::string(name) == "huge.png" ? 18 : bytes.find(kStart) + 5;
    const size_t step = std::string(name) == "huge.png" ? 4 : 2;
    for (const size_t i : {at, at + step}) bytes.replace(i, 2, "\x75\x30");  // 30000
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
    EXPECT_THAT(read_colour_image(folder_ / name).error().message, HasSubstr("30000x30000 are more pixels")) << name;
  }
}

TEST_F(ImageFileTest, DeepAndTransparentImagesComeAsEightBitColour) {
  DepthImage deep(4, 3, 1, 0x8012);
  write_depth_image(folder_ / "deep.png", deep).value();
  const ByteImage image = read_colour_image(folder_ / "deep.png").value();
  EXPECT_EQ(image.channels(), 3);
  EXPECT_NEAR(image.at(2, 1, 1), 0x80, 1);
}

TEST_F(ImageFileTest, SaysWhenTheDiskIsFull) {
  fs::create_symlink("/dev/full", folder_ / "full.png");
  EXPECT_THAT(write_image(folder_ / "full.png", gradient(4, 4, 3)).error().message,
              HasSubstr("full.png: cannot be written"));
}

TEST_F(ImageFileTest, SaysWhenItCannotWrite) {
  const ByteImage image = gradient(4, 4, 3);
  EXPECT_THAT(write_image(folder_ / "no_such_folder" / "a.png", image).error().message, HasSubstr("cannot be written"));
  EXPECT_THAT(write_image(folder_ / "a.nonsense", image).error().message, HasSubstr("no image format"));
  EXPECT_THROW((void)write_image(folder_ / "a.png", ByteImage(4, 4, 2)), std::invalid_argument);
}

TEST_F(ImageFileTest, JpegBytesAreAFile) {
  const ByteImage flat(40, 30, 3, 120);
  const std::string bytes = jpeg_bytes(flat, 80);
  std::ofstream(folder_ / "flat.jpg", std::ios::binary) << bytes;
  const ByteImage back = read_colour_image(folder_ / "flat.jpg").value();
  ASSERT_EQ(back.width(), 40);
  EXPECT_NEAR(back.at(20, 15, 1), 120, 2);
  EXPECT_LT(jpeg_bytes(gradient(64, 64, 3), 20).size(), jpeg_bytes(gradient(64, 64, 3), 95).size());
  EXPECT_THROW((void)jpeg_bytes(ByteImage(), 80), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
