#include "silpose/segment/screen_model.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "silpose/base/rng.h"
#include "silpose/synth/colour_scene.h"
#include "silpose/synth/test_scene.h"

namespace silpose {
namespace {

using testing::HasSubstr;
using Rgb = std::array<double, 3>;

// A grey-clad subject with bare arms, a box that walks before a lit screen; 160x120, B, G, R with noise.
struct Stage {
  Rgb screen = {20, 170, 70};
  double unevenness = 0;               // the light falls off by this much from left to right
  double spill = 0;                    // of the screen's light, on the subject
  std::optional<Box> screen_box = {};  // the screen ends there; a beige room around it
  Rgb cloth = {110, 110, 115};

  [[nodiscard]] static Mask subject(int x) {
    Mask mask(160, 120);
    for (int v = 25; v < 100; ++v) {
      for (int u = x; u < x + 26; ++u) mask.set(u, v);
    }
    return mask;
  }
  [[nodiscard]] ByteImage image(int x, uint64_t seed) const {
    const Rgb skin = {190, 140, 115}, room = {175, 165, 145};
    const Mask mask = subject(x);
    ByteImage image(160, 120, 3);
    Rng rng(seed);
    for (int v = 0; v < 120; ++v) {
      for (int u = 0; u < 160; ++u) {
        const double light = 1 - unevenness * u / 160;
        const bool is_room = screen_box && (u < screen_box->x || u >= screen_box->x + screen_box->width ||
                                            v < screen_box->y || v >= screen_box->y + screen_box->height);
        const bool in_shadow = u >= x + 26 && u < x + 46 && v > 50;
        for (size_t c = 0; c < 3; ++c) {
          double level = is_room ? room[c] : screen[c] * light * (in_shadow ? 0.5 : 1);
          if (mask.get(u, v)) level = (u < x + 5 ? skin[c] : cloth[c]) + spill * screen[c];
          image.at(u, v, static_cast<int>(2 - c)) =
              static_cast<uint8_t>(std::clamp(std::lround(level + 2 * rng.normal()), 0L, 255L));
        }
      }
    }
    return image;
  }
  [[nodiscard]] BackgroundSamples samples() const {
    BackgroundSamples samples;
    for (int i = 0; i < 12; ++i) samples.images.push_back(to_luma_chroma(image(30 + 7 * i, 100u + i)));
    return samples;
  }
  // The worst overlap with the truth, inside the screen's hull.
  [[nodiscard]] double worst_iou(const std::optional<KeyColour>& key = {}) const {
    const ScreenModel model = learn_screen(samples(), key).value();
    double worst = 1;
    for (const int x : {32, 60, 90}) {
      Mask found = find_before_screen(model, to_luma_chroma(image(x, 7u + x)));
      for (int y = 0; y < found.height(); ++y) {
        for (size_t i = 0; i < found.row(y).size(); ++i) found.row(y)[i] &= model.inside.row(y)[i];
      }
      worst = std::min(worst, intersection_over_union(found, subject(x)));
    }
    return worst;
  }
};

TEST(KeyColour, IsHexOrAuto) {
  EXPECT_FALSE(parse_key_colour("auto").value().has_value());
  EXPECT_EQ(parse_key_colour("#00b140").value().value(), (KeyColour{0, 177, 64}));
  for (const char* text : {"", "green", "00b140", "#00b14", "#00b1400", "#00b14g", "#-1b140"}) {
    EXPECT_THAT(parse_key_colour(text).error().message, HasSubstr("auto, or #rrggbb")) << text;
  }
  EXPECT_THAT(parse_key_colour("#808080").error().message, HasSubstr("no hue"));
}

TEST(ScreenModel, FindsTheKeyItself) {
  for (const Rgb& screen : {Rgb{20, 170, 70}, Rgb{30, 60, 190}, Rgb{170, 180, 20}}) {
    const ScreenModel model = learn_screen(Stage{.screen = screen}.samples(), {}).value();
    for (size_t c = 0; c < 3; ++c) EXPECT_NEAR(model.key[c], screen[c], 25) << screen[1];
  }
}

TEST(ScreenModel, EvenScreenWithShadow) { EXPECT_GT(Stage().worst_iou(), 0.98); }
TEST(ScreenModel, UnevenLight) { EXPECT_GT(Stage{.unevenness = 0.7}.worst_iou(), 0.98); }
TEST(ScreenModel, SpillOnGreyAndSkinStaysSubject) { EXPECT_GT(Stage{.spill = 0.2}.worst_iou(), 0.98); }
TEST(ScreenModel, BlackClothesAreNoShadow) { EXPECT_GT((Stage{.cloth = {12, 14, 13}}.worst_iou()), 0.97); }
TEST(ScreenModel, BlueScreen) { EXPECT_GT((Stage{.screen = {30, 60, 190}, .spill = 0.1}.worst_iou()), 0.98); }
TEST(ScreenModel, NominalKeyWillDo) { EXPECT_GT(Stage{.unevenness = 0.4}.worst_iou(KeyColour{0, 177, 64}), 0.98); }

TEST(ScreenModel, KnowsWhereTheScreenEnds) {
  const Stage stage{.screen_box = Box{20, 10, 130, 105}};
  const ScreenModel model = learn_screen(stage.samples(), {}).value();
  EXPECT_GT(model.filled, 0.95);
  EXPECT_FALSE(model.inside.get(15, 60));
  EXPECT_FALSE(model.inside.get(155, 60));
  EXPECT_FALSE(model.inside.get(80, 5));
  EXPECT_FALSE(model.inside.get(80, 117));
  EXPECT_NEAR(static_cast<double>(model.inside.count()), 130 * 105, 0.06 * 130 * 105);
  EXPECT_GT(stage.worst_iou(), 0.97);
}

TEST(ScreenModel, WhatIsNotKeptIsNotLookedAt) {
  Mask keep(160, 120);
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 60; ++x) keep.set(x, y);
  }
  // Left blue, right a larger green.
  BackgroundSamples samples;
  for (uint64_t i = 0; i < 4; ++i) {
    ByteImage image = Stage().image(70, i);
    const ByteImage blue = Stage{.screen = {30, 60, 190}}.image(70, i);
    for (int y = 0; y < 120; ++y) {
      for (int x = 0; x < 60; ++x) {
        for (int c = 0; c < 3; ++c) image.at(x, y, c) = blue.at(x, y, c);
      }
    }
    samples.images.push_back(to_luma_chroma(image));
  }
  EXPECT_GT(learn_screen(samples, {}).value().key[1], 140);
  EXPECT_GT(learn_screen(samples, {}, keep).value().key[2], 150);
}

TEST(ScreenModel, SaysWhereThereIsNone) {
  const BackgroundSamples beige = Stage{.screen = {175, 165, 145}}.samples();
  EXPECT_THAT(learn_screen(beige, {}).error().message,
              HasSubstr("no screen: the commonest saturated colour covers 0.0 %"));
  EXPECT_THAT(learn_screen(Stage().samples(), KeyColour{0, 0, 255}).error().message,
              HasSubstr("the key colour's hue covers 0"));
  // Skin and wood are not screens, unless they are named.
  const BackgroundSamples wood = Stage{.screen = {150, 85, 40}}.samples();
  EXPECT_FALSE(learn_screen(wood, {}).ok());
  EXPECT_TRUE(learn_screen(wood, KeyColour{150, 85, 40}).ok());
}

TEST(ScreenModel, SyntheticVideoBeforeGreen) {
  const SyntheticSequence sequence = make_test_scene(12);
  const ColourScene scene(sequence, 0, {.backdrop = Backdrop::kGreen, .noise_sd = 3, .shadow = 0.5});
  BackgroundSamples samples;
  for (int t = 0; t < 12; ++t) samples.images.push_back(to_luma_chroma(scene.draw(t)));
  const ScreenModel model = learn_screen(samples, {}).value();
  for (const int t : {0, 5, 11}) {
    EXPECT_GT(intersection_over_union(find_before_screen(model, samples.images[static_cast<size_t>(t)]),
                                      true_mask(sequence, 0, t)),
              0.9)
        << t;
  }
}

}  // namespace
}  // namespace silpose
