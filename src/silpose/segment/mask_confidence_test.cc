#include "silpose/segment/mask_confidence.h"

#include <gtest/gtest.h>

namespace silpose {
namespace {

Mask block(int x0, int y0, int x1, int y1) {
  Mask mask(200, 100);
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) mask.set(x, y);
  }
  return mask;
}

TEST(MaskConfidence, WhatACleanUpChangedIsInDoubt) {
  ByteImage confidence(200, 100, 1, 255);
  doubt_changes(confidence, block(50, 20, 130, 80), block(50, 20, 120, 80));
  EXPECT_EQ(confidence.at(110, 50), 255);
  EXPECT_LT(confidence.at(125, 50), 128);
  EXPECT_EQ(confidence.at(140, 50), 255);
}

TEST(MaskConfidence, TheLesserOfTwo) {
  ByteImage confidence(2, 1, 1, 100), other(2, 1, 1, 50);
  other.at(1, 0) = 200;
  lower_confidence(confidence, other);
  EXPECT_EQ(confidence.at(0, 0), 50);
  EXPECT_EQ(confidence.at(1, 0), 100);
}

TEST(MaskConfidence, ASharpEdgeIsForgivenAWideOneIsNot) {
  const Mask mask = block(50, 0, 150, 100);
  ByteImage confidence(200, 100, 1, 255);
  for (int y = 0; y < 100; ++y) {
    for (int x = 49; x < 51; ++x) confidence.at(x, y) = 10;
    for (int x = 140; x < 160; ++x) confidence.at(x, y) = 10;
  }
  forgive_edges(confidence, mask);
  EXPECT_EQ(confidence.at(50, 50), 255);
  EXPECT_EQ(confidence.at(150, 50), 10);
  EXPECT_EQ(confidence.at(140, 50), 10) << "its width stays";
}

}  // namespace
}  // namespace silpose
