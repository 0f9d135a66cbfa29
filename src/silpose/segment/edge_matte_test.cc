#include "silpose/segment/edge_matte.h"

#include <gtest/gtest.h>

#include "silpose/segment/background_model.h"
#include "silpose/segment/clean_up.h"
#include "silpose/segment/scene_for_test.h"

namespace silpose {
namespace {

class RefineEdge : public testing::Test {
 protected:
  const TestScene scene;
  const ByteImage empty = to_luma_chroma(scene.backdrop()), image = to_luma_chroma(scene.image(60, 3));
  const Mask truth = scene.subject(60);
};

TEST_F(RefineEdge, BringsAWideAndANarrowMaskBackToTheSubject) {
  for (const int by : {2, -2}) {
    const Mask start = grow(truth, by);
    EXPECT_LT(intersection_over_union(start, truth), 0.9) << by;
    // A band of 2 % of 64 pixels is 2 wide: nearly all of a shift of 2 is within reach.
    EXPECT_GT(intersection_over_union(refine_edge(start, image, empty).mask, truth), 0.96) << by;
  }
}

TEST_F(RefineEdge, TheBackgroundMayBeDarkerNow) {
  TestScene dusk = scene;
  dusk.exposure = 0.75;
  const Mask found = refine_edge(grow(truth, 2), to_luma_chroma(dusk.image(60, 3)), empty).mask;
  EXPECT_GT(intersection_over_union(found, truth), 0.96);
}

TEST_F(RefineEdge, LeavesWhatIsNotKnownOrFarFromTheEdge) {
  const Mask start = grow(truth, 2), nothing(scene.width, scene.height);
  const EdgeMatte unknown = refine_edge(start, image, empty, &nothing);
  EXPECT_EQ(unknown.mask, start);
  EXPECT_EQ(unknown.confidence, ByteImage(scene.width, scene.height, 1, 255));
  Mask hole = truth;
  for (int y = 50; y < 62; ++y) {
    for (int x = 66; x < 78; ++x) hole.set(x, y, false);
  }
  EXPECT_FALSE(refine_edge(hole, image, empty).mask.get(72, 56));  // 6 from the hole's edge
}

TEST_F(RefineEdge, AnotherBackgroundHasLittleSay) {
  ByteImage other = empty;  // of a camera that has moved
  for (int y = 0; y < other.height(); ++y) {
    for (int x = 0; x < other.width(); ++x) {
      for (int c = 0; c < 3; ++c) other.at(x, y, c) = empty.at((x + 6) % other.width(), (y + 6) % other.height(), c);
    }
  }
  EXPECT_GT(intersection_over_union(refine_edge(truth, image, other).mask, truth), 0.96);
}

TEST_F(RefineEdge, ASleeveSaysNothingOfTheHand) {
  // The lower rows have another colour, which lies on the other side of the background's; the mask is right.
  ByteImage dressed = image;
  for (int y = 80; y < 90; ++y) {
    for (int x = 60; x < 84; ++x) {
      dressed.at(x, y, 0) = 170;
      dressed.at(x, y, 1) = 160;
      dressed.at(x, y, 2) = 110;
    }
  }
  const Mask found = refine_edge(truth, dressed, empty).mask;
  EXPECT_GT(intersection_over_union(found, truth), 0.985) << text_from_mask(found);
}

TEST_F(RefineEdge, SureOnlyWhereTheColoursTell) {
  ByteImage alike = image;  // the subject's right half looks like what is behind it
  for (int y = 30; y < 90; ++y) {
    for (int x = 72; x < 84; ++x) {
      for (int c = 0; c < 3; ++c) alike.at(x, y, c) = empty.at(x, y, c);
    }
  }
  const EdgeMatte matte = refine_edge(truth, alike, empty);
  EXPECT_GT(matte.confidence.at(60, 60), 200);
  EXPECT_LT(matte.confidence.at(83, 60), 60);
}

TEST_F(RefineEdge, NothingInNothingOut) {
  const Mask nothing(scene.width, scene.height);
  EXPECT_EQ(refine_edge(nothing, image, empty).mask.count(), 0);
  EXPECT_THROW((void)refine_edge(Mask(3, 3), image, empty), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
