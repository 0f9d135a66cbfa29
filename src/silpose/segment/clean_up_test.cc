#include "silpose/segment/clean_up.h"

#include <gtest/gtest.h>

namespace silpose {
namespace {

Mask cleaned(const char* text, CleanUpOptions options) {
  options.join_gap = 0;
  return choose_blob(mask_from_text(text), options);
}

const char* const kTwoBlobs =
    "##......\n"
    "##...###\n"
    "#....###\n"
    ".....###\n"
    "........\n";

TEST(ChooseBlob, TakesTheLargest) {
  EXPECT_EQ(text_from_mask(cleaned(kTwoBlobs, {})), text_from_mask(mask_from_text("........\n"
                                                                                  ".....###\n"
                                                                                  ".....###\n"
                                                                                  ".....###\n"
                                                                                  "........\n")));
}

TEST(ChooseBlob, RegionSelectsAndDoesNotCut) {
  // 3 of the 5 pixels of the small blob lie inside, and all 5 are kept; of the large one none does.
  const Mask chosen = cleaned(kTwoBlobs, {.region = Box{0, 0, 3, 2}});
  EXPECT_EQ(chosen.count(), 5);
  EXPECT_TRUE(chosen.get(0, 2)) << "outside the region, and still part of the blob";
}

TEST(ChooseBlob, HalfInsideCountsLessDoesNot) {
  EXPECT_EQ(cleaned("####", {.region = Box{0, 0, 2, 1}}).count(), 4);
  EXPECT_EQ(cleaned("####", {.region = Box{0, 0, 1, 1}}).count(), 0);
  EXPECT_EQ(cleaned("####", {.region = Box{-5, -5, 7, 9}}).count(), 4) << "regions may reach over the border";
}

TEST(ChooseBlob, SmallBlobsDoNotCount) {
  EXPECT_EQ(cleaned(kTwoBlobs, {.min_blob_px = 9}).count(), 9);
  EXPECT_EQ(cleaned(kTwoBlobs, {.min_blob_px = 10}).count(), 0);
}

TEST(ChooseBlob, GarbageMaskCutsBeforeBlobsAreCounted) {
  CleanUpOptions options;
  options.garbage_mask = mask_from_text(
      "########\n"
      "######..\n"
      "######..\n"
      "######..\n"
      "########\n");
  EXPECT_EQ(cleaned(kTwoBlobs, options).count(), 5);
  options.garbage_mask = Mask(3, 3);
  EXPECT_THROW((void)cleaned(kTwoBlobs, options), std::invalid_argument);
}

// A subject of two parts, and something larger next to it.
const char* const kCutInTwo =
    "##......\n"
    "##..####\n"
    "....####\n"
    "##..####\n"
    "##..####\n";

TEST(ChooseBlob, KeepsWhatIsExpectedTogetherAndNothingElse) {
  CleanUpOptions options;
  options.join_gap = 0;
  const Mask parts = mask_from_text(kCutInTwo);
  const Mask expected = mask_from_text("##......\n##......\n##......\n##......\n##......\n");
  EXPECT_EQ(choose_blob(parts, options).count(), 16);
  EXPECT_EQ(text_from_mask(choose_blob(parts, options, expected)), text_from_mask(mask_from_text("##......\n"
                                                                                                 "##......\n"
                                                                                                 "........\n"
                                                                                                 "##......\n"
                                                                                                 "##......\n")));
  options.min_blob_px = 5;  // neither part counts
  EXPECT_EQ(choose_blob(parts, options, expected).count(), 16);
  EXPECT_THROW((void)choose_blob(parts, {}, Mask(3, 3)), std::invalid_argument);
}

TEST(ChooseBlob, DoesNotBelieveWhereTooLittleIsThere) {
  const Mask parts = mask_from_text("#...####\n....####\n....####\n....####\n....####\n");
  const Mask expected = mask_from_text("##......\n##......\n##......\n##......\n##......\n");
  CleanUpOptions options;
  options.join_gap = 0;
  EXPECT_EQ(choose_blob(parts, options, expected).count(), 20);
}

TEST(ChooseBlob, DiagonalNeighboursAreOneBlob) { EXPECT_EQ(cleaned("#..\n.#.\n..#", {}).count(), 3); }

TEST(ChooseBlob, SmallGapsAreClosedAndDoNotPartABlob) {
  Mask mask(200, 200), whole(200, 200);
  for (int y = 20; y < 180; ++y) {
    for (int x = 80; x < 120; ++x) {
      if (y != 90 && y != 91) mask.set(x, y);
      whole.set(x, y);
    }
  }
  const Mask joined = choose_blob(mask, {.join_gap = 0.02});
  EXPECT_LE(xor_count(joined, whole), 8) << "but for the ends of the gap, as it should be, unchanged outside";
  EXPECT_EQ(choose_blob(mask, {.join_gap = 0}).count(), 40 * 88);
}

TEST(ChooseBlob, ClosingKeepsAConvexBlobAsItIs) {
  Mask mask(200, 200);
  for (int y = 0; y < 60; ++y) {  // at the border of the image
    for (int x = 150; x < 200; ++x) mask.set(x, y);
  }
  EXPECT_EQ(choose_blob(mask, {.join_gap = 0.05}), mask);
}

TEST(ChooseBlob, NothingGivesNothing) {
  EXPECT_EQ(choose_blob(Mask(30, 20), {}), Mask(30, 20));
  EXPECT_EQ(choose_blob(Mask(), {}).count(), 0);
}

TEST(ChooseBlob, RefusesImpossibleOptions) {
  EXPECT_THROW((void)choose_blob(Mask(3, 3), {.region = Box{0, 0, 0, 4}}), std::invalid_argument);
  EXPECT_THROW((void)choose_blob(Mask(3, 3), {.min_blob_px = -2}), std::invalid_argument);
  EXPECT_THROW((void)choose_blob(Mask(3, 3), {.join_gap = 2}), std::invalid_argument);
}

TEST(FillHoles, FillsSmallOnesOnly) {
  const Mask mask = mask_from_text(
      "..........\n"
      ".########.\n"
      ".#.##...#.\n"
      ".####...#.\n"
      ".########.\n");
  const Mask filled = fill_holes(mask, 5);
  EXPECT_TRUE(filled.get(2, 2));
  EXPECT_FALSE(filled.get(5, 2));
  EXPECT_EQ(fill_holes(mask, 6).count(), 8 * 4);
  EXPECT_EQ(fill_holes(mask, 0), mask);
}

TEST(FillHoles, ABayIsNotAHole) {
  const Mask bay = mask_from_text("###\n#..\n###");
  EXPECT_EQ(fill_holes(bay, 100), bay);
  const Mask diagonal = mask_from_text("###\n#.#\n##.");  // 4-connected background: the corner does not leak
  EXPECT_TRUE(fill_holes(diagonal, 1).get(1, 1));
}

TEST(Grow, ByADiscBothWays) {
  const Mask dot = mask_from_text(".....\n.....\n..#..\n.....\n.....");
  EXPECT_EQ(grow(dot, 1), mask_from_text(".....\n..#..\n.###.\n..#..\n....."));
  EXPECT_EQ(grow(grow(dot, 2), -2), dot);
  EXPECT_EQ(grow(dot, 0), dot);
  EXPECT_EQ(grow(mask_from_text("###\n###\n###"), -1).count(), 9) << "the border does not shrink it";
}

TEST(ChooseBlob, KeepsPartsThatAreCutOffButNoCrumbsAndNobodyElse) {
  const auto fill = [](Mask& mask, const Box& box) {
    for (int y = box.y; y < box.y + box.height; ++y) {
      for (int x = box.x; x < box.x + box.width; ++x) mask.set(x, y);
    }
  };
  Mask person(200, 200);
  fill(person, {80, 60, 40, 100});
  fill(person, {92, 43, 14, 14});  // the head: 3 above, 4.9 % of the size
  Mask all = person;
  fill(all, {123, 100, 3, 3});   // a crumb next to it
  fill(all, {140, 60, 20, 30});  // too far
  fill(all, {30, 60, 47, 60});   // near, and another person
  EXPECT_EQ(choose_blob(all, {.join_gap = 0}), person);
}

}  // namespace
}  // namespace silpose
