#include "silpose/segment/plate.h"

#include <gtest/gtest.h>

#include <cmath>

#include "silpose/segment/background_model.h"
#include "silpose/segment/scene_for_test.h"

namespace silpose {
namespace {

TEST(LearnPlate, SeesBehindWhoIsThereMostOfTheTime) {
  const TestScene scene;
  std::vector<ByteImage> images;
  std::vector<Mask> masks;
  for (int i = 0; i < 40; ++i) {  // stands for three quarters of the clip, and never leaves the image
    const int x = i < 30 ? 60 : 100;
    images.push_back(to_luma_chroma(scene.image(x, static_cast<uint64_t>(i))));
    masks.push_back(scene.subject(x));
  }
  const Plate plate = learn_plate(images, masks);
  const ByteImage truth = to_luma_chroma(scene.backdrop());
  EXPECT_EQ(plate.known.count(), scene.width * scene.height);
  for (int y = 35; y < 85; ++y) {
    EXPECT_NEAR(plate.colours.at(70, y, 0), truth.at(70, y, 0), 4) << y;
    EXPECT_NEAR(plate.colours.at(110, y, 0), truth.at(110, y, 0), 4) << y;
  }
}

TEST(LearnPlate, KnowsWhatItDoesNotKnow) {
  const TestScene scene;
  std::vector<ByteImage> images;
  std::vector<Mask> masks;
  for (int i = 0; i < 20; ++i) {
    images.push_back(to_luma_chroma(scene.image(60, static_cast<uint64_t>(i))));
    masks.push_back(i < 16 ? scene.subject(60) : Mask(scene.width, scene.height));  // not found in the last four
  }
  const Plate plate = learn_plate(images, masks);
  EXPECT_FALSE(plate.known.get(70, 60));
  EXPECT_FALSE(plate.known.get(58, 60)) << "the mask's edge is not trusted";
  EXPECT_TRUE(plate.known.get(40, 60));
  EXPECT_EQ(learn_plate({images[0]}, {Mask(scene.width, scene.height)}).known.count(), 0);
}

}  // namespace
}  // namespace silpose
