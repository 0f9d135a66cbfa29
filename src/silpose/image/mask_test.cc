#include "silpose/image/mask.h"

#include <gtest/gtest.h>

#include <stdexcept>

namespace silpose {
namespace {

// An image of noise, whose bits come from a plain congruential generator.
ByteImage noise_image(int width, int height, uint32_t seed) {
  ByteImage image(width, height);
  for (uint8_t& pixel : image.pixels()) {
    seed = seed * 1664525u + 1013904223u;
    pixel = static_cast<uint8_t>(seed >> 24);
  }
  return image;
}

TEST(Mask, CountsTypedImages) {
  const Mask a = mask_from_text(R"(
    ..##.
    .###.
    .....)");
  const Mask b = mask_from_text(R"(
    .##..
    .###.
    #....)");
  EXPECT_EQ(a.width(), 5);
  EXPECT_EQ(a.height(), 3);
  EXPECT_EQ(a.count(), 5);
  EXPECT_EQ(xor_count(a, b), 3);
  EXPECT_EQ(and_count(a, b), 4);
  EXPECT_EQ(or_count(a, b), 7);
  EXPECT_DOUBLE_EQ(intersection_over_union(a, b), 4.0 / 7.0);
  EXPECT_EQ(a.bounding_box(), (Box{1, 0, 3, 2}));
  EXPECT_EQ(b.bounding_box(), (Box{0, 0, 4, 3}));
}

TEST(Mask, CountsAgreeWithBytes) {
  for (const int width : {1, 63, 64, 65, 130, 641}) {
    const ByteImage image_a = noise_image(width, 37, 1), image_b = noise_image(width, 37, 99);
    const Mask a = mask_from_image(image_a), b = mask_from_image(image_b, 200);
    int64_t in_a = 0, differ = 0, both = 0, either = 0;
    for (size_t i = 0; i < image_a.pixels().size(); ++i) {
      const bool bit_a = image_a.pixels()[i] >= 128, bit_b = image_b.pixels()[i] >= 200;
      in_a += bit_a;
      differ += bit_a != bit_b;
      both += bit_a && bit_b;
      either += bit_a || bit_b;
    }
    EXPECT_EQ(a.count(), in_a);
    EXPECT_EQ(xor_count(a, b), differ);
    EXPECT_EQ(and_count(a, b), both);
    EXPECT_EQ(or_count(a, b), either);
  }
}

TEST(Mask, BitsBeyondTheWidthStayZero) {
  const Mask mask = mask_from_image(ByteImage(70, 2, 1, 255));
  EXPECT_EQ(mask.count(), 140);
  EXPECT_EQ(mask.row(1)[1], 0x3fu);
}

TEST(Mask, SetsAndClearsSinglePixels) {
  Mask mask(130, 2);
  mask.set(129, 1);
  mask.set(64, 0);
  EXPECT_TRUE(mask.get(129, 1));
  EXPECT_EQ(mask.bounding_box(), (Box{64, 0, 66, 2}));
  mask.set(64, 0, false);
  EXPECT_EQ(mask.count(), 1);
  mask.clear();
  EXPECT_TRUE(mask.bounding_box().empty());
}

TEST(Mask, EmptyMasksAreEqual) {
  EXPECT_EQ(intersection_over_union(Mask(4, 4), Mask(4, 4)), 1.0);
  EXPECT_TRUE(Mask(4, 4).bounding_box().empty());
  EXPECT_EQ(Mask().count(), 0);
}

TEST(Mask, TextAndImagesGoRoundTrip) {
  const Mask mask = mask_from_image(noise_image(77, 5, 7));
  EXPECT_EQ(mask_from_text(text_from_mask(mask)), mask);
  EXPECT_EQ(mask_from_image(image_from_mask(mask)), mask);
}

TEST(Mask, RowsGoToBytesAndBack) {
  for (const int width : {1, 7, 8, 9, 63, 64, 65, 130}) {
    const Mask mask = mask_from_image(noise_image(width, 3, 11));
    for (int y = 0; y < mask.height(); ++y) {
      std::vector<uint8_t> bytes(static_cast<size_t>(width), 7);
      bytes_from_bits(mask.row(y), bytes);
      for (int x = 0; x < width; ++x) EXPECT_EQ(bytes[static_cast<size_t>(x)], mask.get(x, y) ? 255 : 0) << width;
      for (const int value : {1, 127, 128, 255}) {
        for (uint8_t& byte : bytes) byte = byte != 0 ? static_cast<uint8_t>(value) : 0;
        Mask back(width, 1);
        bits_from_bytes(bytes, back.row(0));
        for (int x = 0; x < width; ++x) EXPECT_EQ(back.get(x, 0), mask.get(x, y)) << width << " " << value;
      }
    }
  }
}

TEST(Mask, RefusesWhatCannotBe) {
  EXPECT_THROW(Mask(-1, 2), std::invalid_argument);
  EXPECT_THROW(xor_count(Mask(2, 2), Mask(3, 2)), std::invalid_argument);
  EXPECT_THROW(mask_from_text("##\n#"), std::invalid_argument);
  EXPECT_THROW(mask_from_text("#x"), std::invalid_argument);
  EXPECT_THROW(mask_from_image(ByteImage(2, 2, 3)), std::invalid_argument);
}

TEST(Mask, WithoutSomePixels) {
  const Mask mask = mask_from_text("##.\n.##"), removed = mask_from_text("#..\n..#");
  EXPECT_EQ(text_from_mask(without(mask, removed)), text_from_mask(mask_from_text(".#.\n.#.")));
  EXPECT_THROW(without(mask, Mask(2, 2)), std::invalid_argument);
}

TEST(Mask, AdjacentInRowsColumnsAndAcrossWords) {
  for (const auto& [x, y] : {std::pair(63, 5), {65, 5}, {64, 4}, {64, 6}}) {
    Mask a(130, 10), b(130, 10);
    a.set(64, 5), b.set(x, y);
    EXPECT_TRUE(are_adjacent(a, b)) << x << " " << y;
    EXPECT_TRUE(are_adjacent(b, a)) << x << " " << y;
  }
  for (const auto& [x, y] : {std::pair(66, 5), {63, 4}, {65, 6}, {64, 7}, {0, 6}}) {
    Mask a(130, 10), b(130, 10);
    a.set(64, 5), b.set(x, y);
    EXPECT_FALSE(are_adjacent(a, b)) << x << " " << y;
  }
}

}  // namespace
}  // namespace silpose
