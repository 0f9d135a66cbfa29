#include "silpose/segment/background_doubt.h"

#include <gtest/gtest.h>

#include "silpose/segment/scene_for_test.h"

namespace silpose {
namespace {

TEST(DoubtBackground, DistinguishesAWalkFromAStay) {
  const TestScene scene;
  BackgroundSamples passing;
  for (int i = 0; i < 41; ++i) {
    passing.images.push_back(to_luma_chroma(scene.image(-30 + 5 * i, static_cast<uint64_t>(i))));
  }
  const BackgroundDoubt none = doubt_background(learn_background(passing), passing);
  EXPECT_LT(none.half_covered, 0.002);
  EXPECT_GT(none.ever_covered, 0.3);

  BackgroundSamples staying;
  for (int i = 0; i < 40; ++i) {
    staying.images.push_back(to_luma_chroma(scene.image(i < 15 ? 60 : 61 + 5 * i, static_cast<uint64_t>(i))));
  }
  const BackgroundModel model = learn_background(staying);
  EXPECT_GT(doubt_background(model, staying).half_covered, 0.02);
  EXPECT_EQ(doubt_background(model, staying, Box{0, 0, 30, 120}).half_covered, 0);

  BackgroundSamples still;
  for (int i = 0; i < 40; ++i) still.images.push_back(to_luma_chroma(scene.image(60, static_cast<uint64_t>(i))));
  EXPECT_LT(doubt_background(learn_background(still), still).ever_covered, 0.002);
}

}  // namespace
}  // namespace silpose
