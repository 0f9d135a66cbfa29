// make_segmenter() with depth images.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "silpose/base/rng.h"
#include "silpose/segment/make_segmenter_for_test.h"

namespace silpose {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST_F(MakeSegmenterTest, DepthJoinsTheColours) {
  // A subject of the background's own colours, its shadow, and a sensor that now and then sees nothing.
  const TestScene scene{.shadow = 0.4};
  const auto camouflaged = [&](int i) {
    ByteImage image = scene.image(place(i), static_cast<uint64_t>(i));
    const ByteImage empty = scene.image(-100, static_cast<uint64_t>(i) + 1000);
    for (int v = 0; v < image.height(); ++v) {
      for (int u = 0; u < image.width(); ++u) {
        for (int c = 0; c < 3 && truth(i).get(u, v); ++c) image.at(u, v, c) = empty.at(u, v, c);
      }
    }
    return image;
  };
  const auto depth = [&](int i, int num_blind_rows) {
    DepthImage image(scene.width, scene.height, 1, 4000);
    Rng rng(static_cast<uint64_t>(i));
    for (int v = 0; v < image.height(); ++v) {
      for (int u = 0; u < image.width(); ++u) {
        const bool is_subject = truth(i).get(u, v);
        const double metres = is_subject ? 3 : 4;
        image.at(u, v) = static_cast<uint16_t>(std::lround(1000 * metres + 1.4 * metres * metres * rng.normal()));
        if (rng.uniform() < 0.02 || (is_subject && v < 30 + num_blind_rows)) image.at(u, v) = 0;
      }
    }
    return image;
  };
  for (const char* name : {"same", "depth", "blind"}) fs::create_directories(at(name));
  for (int i = 0; i < kFrames; ++i) {
    write_image(at(fmt::format("same/{:03}.png", i)), camouflaged(i)).value();
    write_depth_image(at(fmt::format("depth/{:03}.png", i)), depth(i, 0)).value();
    write_depth_image(at(fmt::format("blind/{:03}.png", i)), depth(i, 25)).value();
  }
  const auto worst = [&](const SegmenterOptions& options, const std::string& clip) {
    const auto segmenter = make_of(at(clip), options).value();
    double least = 1;
    for (int i = 15; i < 45; i += 5) {
      const ByteImage shown = clip == "same" ? camouflaged(i) : image(i);
      least = std::min(least, intersection_over_union(segmenter->segment(shown, i)->mask, truth(i)));
    }
    return least;
  };
  EXPECT_LT(worst({.kind = "background"}, "same"), 0.3) << "colour cannot distinguish them";
  EXPECT_GT(worst({.kind = "background", .depth = at("depth")}, "same"), 0.95);
  EXPECT_LT(worst({.kind = "depth", .depth = at("blind")}, "clip"), 0.7) << "depth alone cannot distinguish them";
  EXPECT_GT(worst({.kind = "background", .depth = at("blind")}, "clip"), 0.95);
  EXPECT_EQ(make_of(at("same"), {.kind = "background", .depth = at("depth")}).value()->name(),
            "background auto with depth");
  EXPECT_THAT(make_of(at("clip"), {.kind = "background", .background = BackgroundOnline{}, .depth = at("depth")})
                  .error()
                  .message,
              HasSubstr("not an online one"));
}

TEST_F(MakeSegmenterTest, DepthSegmentsByItself) {
  const auto depth = [&](int i) {
    DepthImage image(scene_.width, scene_.height, 1, 4000);
    const Mask mask = truth(i);
    for (int y = 0; y < image.height(); ++y) {
      for (int x = 0; x < image.width(); ++x) {
        if (mask.get(x, y)) image.at(x, y) = 3000;
      }
    }
    return image;
  };
  fs::create_directories(at("depth"));
  for (int i = 0; i < kFrames; ++i) write_depth_image(at(fmt::format("depth/{:03}.png", i + 1)), depth(i)).value();
  SegmenterOptions options{.kind = "depth", .depth = at("depth")};
  for (const std::optional<DepthRange>& range : {std::optional<DepthRange>(), std::optional(DepthRange{2.5, 3.5})}) {
    options.depth_range = range;
    const auto segmenter = make_of(at("clip"), options).value();
    EXPECT_EQ(segmenter->name(), range ? "depth 2.5 to 3.5 m" : "depth auto");
    EXPECT_THAT(segmenter->warnings(), IsEmpty());
    EXPECT_EQ(segmenter->first_index(), 0);  // as many as frames: in order, whatever they are numbered from
    for (const int i : {0, 25, 49}) EXPECT_EQ(segmenter->segment(image(i), i).value().mask, truth(i)) << i;
    EXPECT_THAT(segmenter->segment(image(49), 50).error().message, HasSubstr("50 depth images, frame 50 has none"));
  }

  EXPECT_THAT(failure({.kind = "depth"}), HasSubstr("no depth images are given"));
  EXPECT_THAT(failure({.kind = "depth", .depth = at("none")}), HasSubstr("none: no such file or directory"));
  EXPECT_THAT(failure({.kind = "depth", .depth = at("clip")}), HasSubstr("3 channels of 8 bits, depth is one of 16"));
  for (const int number : {48, 49, 50}) fs::remove(at(fmt::format("depth/{:03}.png", number)));
  EXPECT_THAT(failure({.kind = "depth", .depth = at("depth")}), HasSubstr("47 depth images for 50 frames of"));
  for (const char* folder : {"few", "small", "flat"}) fs::create_directories(at(folder));
  for (int i = 0; i < 2; ++i) {
    write_image(at(fmt::format("few/{}.png", i)), image(i)).value();
    write_depth_image(at(fmt::format("small/{}.png", i)), DepthImage(80, 60, 1, 900)).value();
    write_depth_image(at(fmt::format("flat/{}.png", i)), DepthImage(160, 120, 1, 900)).value();
  }
  EXPECT_THAT(make_of(at("few"), {.kind = "depth", .depth = at("small")}).error().message,
              HasSubstr("small/0.png: depth of 80x60 for images of 160x120"));
  EXPECT_THAT(make_of(at("few"), {.kind = "depth", .depth = at("flat")}).value()->warnings(),
              ElementsAre(HasSubstr("almost nothing is ever nearer than the background")));
}

}  // namespace
}  // namespace silpose
