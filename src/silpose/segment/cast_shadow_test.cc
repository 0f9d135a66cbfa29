#include "silpose/segment/cast_shadow.h"

#include <gtest/gtest.h>

#include "silpose/segment/foreground.h"
#include "silpose/segment/scene_for_test.h"

namespace silpose {
namespace {

class FindCastShadow : public testing::Test {
 protected:
  FindCastShadow() {
    BackgroundSamples samples;
    for (int i = 0; i < 30; ++i) samples.images.push_back(to_luma_chroma(scene.image(-100, static_cast<uint64_t>(i))));
    model = learn_background(samples);
  }

  // Where the luma is not the background's.
  [[nodiscard]] ByteImage differs(const ByteImage& luma_chroma) const {
    ByteImage result(scene.width, scene.height);
    for (int y = 0; y < scene.height; ++y) {
      for (int x = 0; x < scene.width; ++x) {
        result.at(x, y) = std::abs(luma_chroma.at(x, y) - model.median.at(x, y)) > 12 ? 1 : 0;
      }
    }
    return result;
  }

  // The part of a box that is marked.
  static double marked(const ByteImage& image, const Box& box) {
    int count = 0;
    for (int y = box.y; y < box.y + box.height; ++y) {
      for (int x = box.x; x < box.x + box.width; ++x) count += image.at(x, y) != 0 ? 1 : 0;
    }
    return static_cast<double>(count) / (box.width * box.height);
  }

  TestScene scene;
  BackgroundModel model;
};

TEST_F(FindCastShadow, DistinguishesTheShadowFromTheSubject) {
  for (const double darker : {0.25, 0.35, 0.5}) {
    scene.shadow = darker;
    const ByteImage image = to_luma_chroma(scene.image(50, 7));
    const CastShadow found = find_cast_shadow(model, image, 1, differs(image));
    EXPECT_GT(marked(found.shadow, {76, 72, 26, 21}), 0.95) << darker;
    EXPECT_LT(marked(found.shadow, {52, 32, 20, 56}), 0.02) << darker;
    EXPECT_NEAR(found.floor_row, 75, 6) << darker;
    EXPECT_LT(marked(found.looks_like, {52, 30, 60, 35}), 0.001) << "only on the floor";
  }
}

TEST_F(FindCastShadow, OneLightHasOneFactor) {
  scene.shadow = 0.3;
  ByteImage image = to_luma_chroma(scene.image(50, 7));
  // A dark trouser leg of the background's hue, next to the shadow.
  for (int y = 70; y < 90; ++y) {
    for (int x = 104; x < 112; ++x) image.at(x, y) = static_cast<uint8_t>(0.43 * model.median.at(x, y));
  }
  const CastShadow found = find_cast_shadow(model, image, 1, differs(image));
  EXPECT_GT(marked(found.shadow, {76, 72, 26, 21}), 0.95);
  EXPECT_LT(marked(found.shadow, {106, 72, 5, 16}), 0.05);
}

TEST_F(FindCastShadow, NoneWhereNothingIsDarker) {
  const ByteImage empty = to_luma_chroma(scene.image(-100, 99));
  EXPECT_EQ(find_cast_shadow(model, empty, 1, differs(empty)).shadow, ByteImage(scene.width, scene.height));
  const ByteImage walker = to_luma_chroma(scene.image(50, 99));
  EXPECT_LT(marked(find_cast_shadow(model, walker, 1, differs(walker)).shadow, {0, 0, 160, 120}), 0.002);
}

TEST_F(FindCastShadow, TheWholeImageMayBeDarker) {
  scene.shadow = 0.35;
  scene.exposure = 0.8;
  const ByteImage image = to_luma_chroma(scene.image(50, 7));
  const CastShadow found = find_cast_shadow(model, image, exposure_gain(model, image), differs(image));
  EXPECT_GT(marked(found.shadow, {76, 72, 26, 21}), 0.95);
  EXPECT_LT(marked(found.shadow, {110, 30, 40, 80}), 0.02);
}

TEST_F(FindCastShadow, HardShadowsAreNoForeground) {
  ForegroundFinder finder(model);
  for (const double darker : {0.35, 0.5}) {
    scene.shadow = darker;
    const Mask found = finder.find(to_luma_chroma(scene.image(50, 7)));
    EXPECT_GT(intersection_over_union(found, scene.subject(50)), 0.95) << darker << "\n" << text_from_mask(found);
  }
}

TEST_F(FindCastShadow, RefusesAnotherSize) {
  const ByteImage image(10, 10, 3);
  EXPECT_THROW((void)find_cast_shadow(model, image, 1, ByteImage(10, 10)), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
