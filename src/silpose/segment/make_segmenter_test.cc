#include "silpose/segment/make_segmenter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "silpose/image/memory_source.h"
#include "silpose/segment/make_segmenter_for_test.h"

namespace silpose {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST_F(MakeSegmenterTest, BackgroundOfTheWholeClip) {
  const auto segmenter = make_of(at("clip")).value();
  EXPECT_EQ(segmenter->name(), "background auto");
  EXPECT_EQ(segmenter->first_index(), 0);
  EXPECT_THAT(segmenter->warnings(), IsEmpty());
  expect_finds_subject(*segmenter, 0);
}

// Each continues from its state as the one that gave it; one that learns online from seeing all.
TEST_F(MakeSegmenterTest, GoesOnFromItsState) {
  write_masks("masks", kFrames);
  const SegmenterOptions kinds[] = {{.kind = "background"},
                                    {.kind = "background", .background = BackgroundOnline{}},
                                    {.kind = "masks", .masks = at("masks")}};
  for (const SegmenterOptions& options : kinds) {
    const auto whole = make_of(at("clip"), options).value();
    const auto second = make_of(at("clip"), options).value();
    for (int i = 0; i < kFrames; ++i) {
      if (i == 30) second->restore(whole->state());
      const ByteImage shown = i == 35 ? image(0) : image(i);  // lost for once: the area jumps
      const Observation expected = whole->segment(shown, i).value();
      if (i < 30 && !second->sees_all()) continue;
      const Observation found = second->segment(shown, i).value();
      EXPECT_EQ(found.mask, expected.mask) << whole->name() << " " << i;
      EXPECT_TRUE(std::ranges::equal(found.confidence.pixels(), expected.confidence.pixels())) << i;
      EXPECT_EQ(found.trust.overall, expected.trust.overall) << whole->name() << " " << i;
    }
    EXPECT_THROW(second->restore("x"), std::invalid_argument);
  }
}

TEST_F(MakeSegmenterTest, BackgroundOfTheLeadIn) {
  const auto segmenter = make_of(at("clip"), {.background = BackgroundLeadIn{1}}, 10).value();
  EXPECT_EQ(segmenter->first_index(), 10);
  expect_finds_subject(*segmenter, 10);
}

TEST_F(MakeSegmenterTest, BackgroundFromAPlateOrAClipOfTheEmptyScene) {
  write_image(at("plate.png"), scene_.image(-100, 77)).value();
  std::filesystem::create_directories(at("empty"));
  for (int i = 0; i < 8; ++i) write_image(at(fmt::format("empty/{}.png", i)), scene_.image(-100, 80u + i)).value();
  for (const char* background : {"plate.png", "empty"}) {
    const auto segmenter = make_of(at("clip"), {.background = BackgroundPlate{at(background)}}).value();
    expect_finds_subject(*segmenter, 0);
  }
}

TEST_F(MakeSegmenterTest, OnlineMixturesLearnFromTheEmptyStart) {
  for (const bool knn : {false, true}) {
    const auto segmenter = make_of(at("clip"), {.background = BackgroundOnline{knn}}).value();
    EXPECT_EQ(segmenter->name(), knn ? "background online:knn" : "background online");
    double worst = 1;
    for (int i = 0; i < kFrames; ++i) {
      const Observation result = segmenter->segment(image(i), i).value();
      if (i < 10) {
        EXPECT_EQ(result.trust.overall, 0);
      } else if (truth(i).count() == 24 * 60) {
        worst = std::min(worst, intersection_over_union(result.mask, truth(i)));
      }
    }
    EXPECT_GT(worst, 0.8) << (knn ? "knn" : "mog2");
  }
}

TEST_F(MakeSegmenterTest, GivenMasksComeThroughUnchanged) {
  write_masks("masks", kFrames);
  const auto segmenter = make_of(at("clip"), {.masks = at("masks")}).value();
  EXPECT_EQ(segmenter->name(), "masks");
  for (int i : {12, 13, 30, 49}) {  // indices may skip
    EXPECT_EQ(segmenter->segment(image(i), i).value().mask, truth(i)) << i;
  }
}

TEST_F(MakeSegmenterTest, MasksThatBeginLaterBelongToTheFramesOfTheirNumbers) {
  write_masks("masks", kFrames - 20, 20, 20);
  const auto segmenter = make_of(at("clip"), {.masks = at("masks")}).value();
  EXPECT_EQ(segmenter->first_index(), 20);
  EXPECT_EQ(segmenter->segment(image(30), 30).value().mask, truth(30));
}

TEST_F(MakeSegmenterTest, AsManyMasksAsFramesBelongTogetherInOrder) {
  write_masks("masks", kFrames, 0, 1);  // numbered from 1, as some programs do
  const auto segmenter = make_of(at("clip"), {.masks = at("masks")}).value();
  EXPECT_EQ(segmenter->first_index(), 0);
  EXPECT_EQ(segmenter->segment(image(30), 30).value().mask, truth(30));
}

TEST_F(MakeSegmenterTest, MasksOfOtherFramesAreRefused) {
  write_masks("after", 20, 0, 50);
  EXPECT_THAT(failure({.masks = at("after")}), HasSubstr("after: 20 masks for 50 frames of"));
  write_masks("gap", kFrames);
  std::filesystem::remove(at("gap/031.png"));
  const auto segmenter = make_of(at("clip"), {.masks = at("gap")}).value();
  EXPECT_TRUE(segmenter->segment(image(30), 30).ok());
  EXPECT_THAT(segmenter->segment(image(31), 31).error().message, HasSubstr("frame 31 has none"));
}

TEST_F(MakeSegmenterTest, LeadInCountsFromTheFirstImageWhateverItsNumber) {
  std::filesystem::create_directories(at("later"));
  for (int i = 0; i < kFrames; ++i) write_image(at(fmt::format("later/{}.png", 200 + i)), image(i)).value();
  const auto segmenter = make_of(at("later"), {.background = BackgroundLeadIn{1}}, 10).value();
  EXPECT_EQ(segmenter->first_index(), 210);
  EXPECT_GT(intersection_over_union(segmenter->segment(image(30), 230).value().mask, truth(30)), 0.9);
}

TEST_F(MakeSegmenterTest, TheInputItselfMayBeTheMasks) {
  write_masks("masks", kFrames);
  const auto segmenter = make_of(at("masks"), {.kind = "masks"}).value();
  const ByteImage image = read_colour_image(at("masks/030.png")).value();
  EXPECT_EQ(segmenter->segment(image, 30).value().mask, truth(30));
}

TEST_F(MakeSegmenterTest, AClipOfMasksIsTakenForMasks) {
  write_masks("masks", kFrames);  // the first ones are all black
  const auto segmenter = make_of(at("masks")).value();
  EXPECT_EQ(segmenter->name(), "masks");
  EXPECT_THAT(segmenter->warnings(), ElementsAre(HasSubstr("masks: black and white only, so used as masks")));
  EXPECT_EQ(segmenter->segment(read_colour_image(at("masks/030.png")).value(), 30)->mask, truth(30));
  VideoWriter writer = create_video(at("masks.mp4"), truth(0).width(), truth(0).height(), 10).value();
  for (int i = 0; i < kFrames; ++i) writer.write(image_from_mask(truth(i))).value();
  writer.close().value();
  EXPECT_EQ(make_of(at("masks.mp4")).value()->name(), "masks");
  // Not where something else is asked for, nor a film.
  EXPECT_EQ(make_of(at("masks"), {.kind = "background"}).value()->name(), "background auto");
  EXPECT_EQ(make_of(at("masks"), {.background = BackgroundOnline{}}).value()->name(), "background online");
  EXPECT_EQ(make_of(at("clip")).value()->name(), "background auto");
}

TEST_F(MakeSegmenterTest, ImagesThatAreNoMasksAreReported) {
  const auto segmenter = make_of(at("clip"), {.kind = "masks"}).value();
  EXPECT_THAT(segmenter->warnings(), IsEmpty());
  for (int i = 0; i < 3; ++i) (void)segmenter->segment(image(i), i).value();
  EXPECT_THAT(segmenter->warnings(), ElementsAre(HasSubstr("clip: not only black and white")));
}

TEST_F(MakeSegmenterTest, TooFewMasks) {
  write_masks("masks", kFrames - 8);
  EXPECT_THAT(failure({.masks = at("masks")}), HasSubstr("masks: 42 masks for 50 frames of"));

  write_masks("one_less", kFrames - 1);  // a container's count may be off by one: found when it happens
  const auto segmenter = make_of(at("clip"), {.masks = at("one_less")}).value();
  EXPECT_TRUE(segmenter->segment(image(48), 48).ok());
  EXPECT_THAT(segmenter->segment(image(49), 49).error().message, HasSubstr("49 masks, frame 49 has none"));
}

TEST_F(MakeSegmenterTest, OtherSizesAreRefused) {
  write_image(at("plate.png"), ByteImage(80, 60, 3)).value();
  EXPECT_THAT(failure({.background = BackgroundPlate{at("plate.png")}}),
              HasSubstr("a background of 80x60 for images of 160x120"));
  EXPECT_THAT(failure({.masks = at("plate.png")}), HasSubstr("masks of 80x60 for images of 160x120"));
  SegmenterOptions options;
  options.clean_up.garbage_mask = Mask(80, 60);
  EXPECT_THAT(failure(options), HasSubstr("garbage mask is 80x60"));
  options.clean_up.garbage_mask.reset();
  options.clean_up.region = Box{160, 0, 20, 20};
  EXPECT_THAT(failure(options), HasSubstr("outside its images of 160x120"));
  const auto segmenter = make_of(at("clip")).value();
  EXPECT_FALSE(segmenter->segment(ByteImage(80, 60, 3), 0).ok());
}

TEST_F(MakeSegmenterTest, SettingsThatCannotBe) {
  EXPECT_THAT(failure({.kind = "magic"}), HasSubstr("segmenter 'magic': unknown"));
  EXPECT_THAT(failure({.background = BackgroundPlate{at("none.png")}}), HasSubstr("none.png: no such file"));
  EXPECT_THAT(failure({.background = BackgroundLeadIn{600}}), HasSubstr("ends within its lead-in"));
  EXPECT_THAT(failure({.masks = at("none")}), HasSubstr("none: no such file"));
  EXPECT_THAT(make_of(at("no_clip.mp4")).error().message, HasSubstr("no_clip.mp4: no such file"));
}

// The scene's subject in front of a green screen that covers all but the image's left edge.
TEST_F(MakeSegmenterTest, ChromaKeysAndLeavesOutWhatLiesOutsideTheScreen) {
  const auto keyed = [&](int i) {
    ByteImage screened = image(i);
    const Mask mask = truth(i);
    for (int y = 0; y < screened.height(); ++y) {
      for (int x = 12; x < screened.width(); ++x) {
        for (int c = 0; c < 3; ++c) {
          if (!mask.get(x, y))
            screened.at(x, y, c) = static_cast<uint8_t>(screened.at(x, y, c) / 8 + (c == 1 ? 130 : 20));
        }
      }
    }
    return screened;
  };
  std::filesystem::create_directories(at("green"));
  for (int i = 0; i < kFrames; ++i) write_image(at(fmt::format("green/{:02}.png", i)), keyed(i)).value();
  SegmenterOptions options{.kind = "chroma"};
  auto segmenter = make_of(at("green"), options).value();
  EXPECT_THAT(segmenter->name(), HasSubstr("chroma #"));
  EXPECT_THAT(segmenter->warnings(), ElementsAre(HasSubstr("8 % of the image lies outside the screen")));
  for (const int i : {0, 20, 30}) {
    const Observation result = segmenter->segment(keyed(i), i).value();
    EXPECT_GT(intersection_over_union(result.mask, truth(i)), 0.97) << i;
    EXPECT_EQ(result.trust.nothing_found, truth(i).count() == 0) << i;
  }
  // With a garbage mask it is the user who says what to leave out.
  options.clean_up.garbage_mask = Mask(160, 120);
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 100; ++x) options.clean_up.garbage_mask->set(x, y);
  }
  segmenter = make_of(at("green"), options).value();
  EXPECT_THAT(segmenter->warnings(), IsEmpty());
  const Observation cut = segmenter->segment(keyed(45), 45).value();
  EXPECT_EQ(cut.box(), (Box{0, 0, 12, 120}));
  ASSERT_NE(cut.ignored, nullptr);
  EXPECT_EQ(cut.ignored, segmenter->ignored());
  EXPECT_EQ(cut.ignored->bounding_box(), (Box{100, 0, 60, 120}));
  EXPECT_EQ(cut.ignored->count(), 60 * 120);
  EXPECT_THAT(failure({.kind = "chroma"}), HasSubstr("clip: no screen"));
}

TEST_F(MakeSegmenterTest, WarnsOfASubjectWhoStays) {
  std::filesystem::create_directories(at("still"));
  for (int i = 0; i < 12; ++i) {
    write_image(at(fmt::format("still/{:02}.png", i)), scene_.image(60, static_cast<uint64_t>(i))).value();
  }
  EXPECT_THAT(make_of(at("still")).value()->warnings(), ElementsAre(HasSubstr("almost nothing moves")));
  std::filesystem::create_directories(at("half"));
  for (int i = 0; i < 20; ++i) {
    write_image(at(fmt::format("half/{:02}.png", i)), scene_.image(i < 8 ? 60 : 6 * i, 5u + i)).value();
  }
  EXPECT_THAT(make_of(at("half")).value()->warnings(), ElementsAre(HasSubstr("something stays")));
}

TEST_F(MakeSegmenterTest, StopsWhenAsked) {
  struct Stop : ProgressSink {
    bool update(std::string_view, int64_t done, int64_t) override { return done < 5; }
  } stop;
  EXPECT_THAT(make_of(at("clip"), {}, 30, &stop).error().message, HasSubstr("stopped"));
}

// What a garbage mask removes is ignored, whatever the segmenter; without one nothing is.
TEST_F(MakeSegmenterTest, WhatAGarbageMaskRemovesIsIgnored) {
  write_masks("masks", kFrames);
  Mask garbage(160, 120);
  for (int y = 0; y < 120; ++y) {
    for (int x = 0; x < 100; ++x) garbage.set(x, y);
  }
  SegmenterOptions kinds[] = {
      {.kind = "background"}, {.kind = "background", .background = BackgroundOnline{}}, {.masks = at("masks")}};
  for (SegmenterOptions& options : kinds) {
    EXPECT_EQ(make_of(at("clip"), options).value()->segment(image(0), 0).value().ignored, nullptr);
    options.clean_up.garbage_mask = garbage;
    const auto segmenter = make_of(at("clip"), options).value();
    ASSERT_NE(segmenter->ignored(), nullptr) << segmenter->name();
    EXPECT_EQ(segmenter->ignored()->bounding_box(), (Box{100, 0, 60, 120}));
    for (int i = 0; i < 45; ++i) {
      const Observation seen = segmenter->segment(image(i), i).value();
      if (seen.trust.nothing_found) continue;
      EXPECT_EQ(seen.ignored, segmenter->ignored()) << segmenter->name() << " " << i;
      EXPECT_EQ(and_count(seen.mask, *seen.ignored), 0) << segmenter->name() << " " << i;
    }
  }
}

// Frames that never were a file, of two cameras, each learned from alone.
TEST_F(MakeSegmenterTest, LearnsFromFramesInMemoryOfEachCamera) {
  std::vector<std::unique_ptr<FrameSource>> sources;
  for (int c = 0; c < 2; ++c) {
    std::vector<ByteImage> images;
    for (int i = 0; i < kFrames; ++i) images.push_back(image(i));
    sources.push_back(std::make_unique<MemorySource>(std::move(images), 10));
  }
  Video video = join_sources(std::move(sources)).value();
  std::vector<std::unique_ptr<Segmenter>> segmenters;
  for (int c = 0; c < 2; ++c) {
    Video alone = video.alone(c);
    segmenters.push_back(make_segmenter(alone).value());
    EXPECT_EQ(segmenters.back()->name(), "background auto");
  }
  EXPECT_THROW((void)make_segmenter(video), std::invalid_argument);
  video.rewind().value();
  int count = 0;
  for (const Frame& frame : video) {
    EXPECT_EQ(frame.index, count++);
    for (size_t c = 0; c < 2; ++c) {
      const Observation seen = segmenters[c]->segment(frame.images[c], frame.index).value();
      const Mask expected = truth(static_cast<int>(frame.index));
      if (expected.count() == 24 * 60) {
        EXPECT_GT(intersection_over_union(seen.mask, expected), 0.93) << frame.index;
      }
    }
  }
  EXPECT_EQ(count, kFrames);
}

}  // namespace
}  // namespace silpose
