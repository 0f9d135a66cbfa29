#include "silpose/segment/background_model.h"

#include <gtest/gtest.h>

#include <cmath>

#include "silpose/base/parallel.h"
#include "silpose/segment/foreground.h"
#include "silpose/segment/scene_for_test.h"

namespace silpose {
namespace {

BackgroundSamples walk(const TestScene& scene, int count = 41) {
  BackgroundSamples samples;
  for (int i = 0; i < count; ++i) {
    samples.images.push_back(to_luma_chroma(scene.image(-30 + 5 * i, static_cast<uint64_t>(i))));
  }
  return samples;
}

TEST(LearnBackground, MedianAndScaleOfAHandWorkedPixel) {
  BackgroundSamples samples;
  for (const int level : {100, 104, 96, 112, 100, 92, 250}) {  // luma; grey images have luma as their level
    samples.images.push_back(to_luma_chroma(ByteImage(3, 3, 3, static_cast<uint8_t>(level))));
  }
  const BackgroundModel model = learn_background(samples);
  EXPECT_EQ(model.median.at(1, 1, 0), 100);
  EXPECT_EQ(model.median.at(1, 1, 1), 128);
  // Deviations 0 0 4 4 8 12 150: the median is 4.
  EXPECT_NEAR(model.noise.at(1, 1, 0), 1.4826 * 4, 1e-3);
}

TEST(LearnBackground, SubjectThatPassesLeavesNoTrace) {
  const TestScene scene;
  const BackgroundModel model = learn_background(walk(scene));
  const ByteImage truth = to_luma_chroma(scene.backdrop());
  double worst = 0, noise_sum = 0;
  for (int y = 0; y < scene.height; ++y) {
    for (int x = 0; x < scene.width; ++x) {
      worst = std::max(worst, std::abs(static_cast<double>(model.median.at(x, y)) - truth.at(x, y)));
      noise_sum += model.noise.at(x, y, 0);
    }
  }
  EXPECT_LE(worst, 3);
  EXPECT_LT(noise_sum / (scene.width * scene.height), 3.7);
}

TEST(LearnBackground, SubjectThatStaysForTwoFifthsDoesNotRaiseTheScale) {
  const TestScene scene;
  BackgroundSamples samples;
  for (int i = 0; i < 50; ++i) {
    samples.images.push_back(to_luma_chroma(scene.image(i < 20 ? 60 : -100, static_cast<uint64_t>(i))));
  }
  const BackgroundModel model = learn_background(samples);
  EXPECT_LT(model.noise.at(70, 60, 1), 6);
  Mask found = ForegroundFinder(model).find(samples.images[3]);
  EXPECT_GT(intersection_over_union(found, scene.subject(60)), 0.95);
}

TEST(LearnBackground, DoesNotDependOnThreads) {
  const BackgroundSamples samples = walk(TestScene());
  BackgroundModel one, many;
  Mask mask_one, mask_many;
  {
    ThreadLimit limit(1);
    one = learn_background(samples);
    mask_one = ForegroundFinder(one).find(samples.images[20]);
  }
  {
    ThreadLimit limit(4);
    many = learn_background(samples);
    mask_many = ForegroundFinder(many).find(samples.images[20]);
  }
  EXPECT_EQ(one.median, many.median);
  EXPECT_EQ(one.noise, many.noise);
  EXPECT_EQ(mask_one, mask_many);
}

TEST(ForegroundFinder, FindsTheSubject) {
  const TestScene scene;
  ForegroundFinder finder(learn_background(walk(scene)));
  for (int x : {0, 40, 100, 130}) {
    const Mask found = finder.find(to_luma_chroma(scene.image(x, 900)));
    EXPECT_GT(intersection_over_union(found, scene.subject(x)), 0.97) << x << "\n" << text_from_mask(found);
  }
  EXPECT_LE(finder.find(to_luma_chroma(scene.image(-100, 901))).count(), 5) << "an empty scene is all but empty";
}

TEST(ForegroundFinder, ShadowsAreBackground) {
  TestScene scene;
  ForegroundFinder finder(learn_background(walk(scene)));
  for (const double darker : {0.15, 0.3}) {
    scene.shadow = darker;
    const Mask found = finder.find(to_luma_chroma(scene.image(50, 7)));
    EXPECT_GT(intersection_over_union(found, scene.subject(50)), 0.93) << darker << "\n" << text_from_mask(found);
  }
}

TEST(ForegroundFinder, ExposureThatChangesIsBackground) {
  TestScene scene;
  ForegroundFinder finder(learn_background(walk(scene)));
  for (const double exposure : {0.85, 1.15}) {
    scene.exposure = exposure;
    const ByteImage image = to_luma_chroma(scene.image(50, 7));
    EXPECT_NEAR(exposure_gain(finder.model(), image), exposure, 0.02);
    EXPECT_GT(intersection_over_union(finder.find(image), scene.subject(50)), 0.95);
  }
}

TEST(ForegroundFinder, RefusesAnotherSize) {
  ForegroundFinder finder(learn_background(walk(TestScene(), 5)));
  EXPECT_THROW((void)finder.find(ByteImage(10, 10, 3)), std::invalid_argument);
}

TEST(BackgroundFromPlate, WorksWithAndWithoutTheClip) {
  const TestScene scene;
  const BackgroundSamples staying{.images = {to_luma_chroma(scene.image(60, 1)), to_luma_chroma(scene.image(60, 2)),
                                             to_luma_chroma(scene.image(60, 3)), to_luma_chroma(scene.image(60, 4)),
                                             to_luma_chroma(scene.image(60, 5))}};
  const ByteImage plate = scene.image(-100, 50);
  for (const BackgroundModel& model : {background_from_plate(plate), background_from_plate(plate, staying)}) {
    const Mask found = ForegroundFinder(model).find(staying.images[2]);
    EXPECT_GT(intersection_over_union(found, scene.subject(60)), 0.95) << text_from_mask(found);
  }
  EXPECT_THROW((void)background_from_plate(ByteImage(8, 8, 3), staying), std::invalid_argument);
}

}  // namespace
}  // namespace silpose
