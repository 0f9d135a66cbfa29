#include "silpose/segment/segmentation_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "silpose/base/folder_for_test.h"
#include "silpose/base/option_error.h"
#include "silpose/image/image_file.h"
#include "silpose/image/memory_source.h"

namespace silpose {
namespace {

using ::testing::HasSubstr;

Video video_of(int num_cameras) {
  std::vector<std::unique_ptr<FrameSource>> sources;
  for (int c = 0; c < num_cameras; ++c) {
    sources.push_back(std::make_unique<MemorySource>(std::vector{ByteImage(32, 24, 3, 0)}, 30));
  }
  return join_sources(std::move(sources)).value();
}

std::vector<SegmenterOptions> of_cameras(const SegmentationOptions& options, int num_cameras = 1) {
  return segmenter_options(options, video_of(num_cameras), "networks").value();
}

std::string refusal(const SegmentationOptions& options) {
  try {
    options.check();
  } catch (const OptionError& wrong) {
    return wrong.what();
  }
  return "";
}

TEST(SegmentationOptions, DefaultsAreThoseOfTheSegmenter) {
  const SegmenterOptions options = of_cameras({}).at(0), defaults;
  EXPECT_EQ(options.kind, "auto");
  EXPECT_EQ(options.networks, "networks");
  EXPECT_FALSE(options.background || options.key_colour || options.depth_range || options.clean_up.region);
  EXPECT_EQ(options.clean_up.min_blob_px, defaults.clean_up.min_blob_px);
  EXPECT_EQ(options.clean_up.grow_px, 0);
}

TEST(SegmentationOptions, OneValueIsForAllCamerasOrEachHasItsOwn) {
  const auto options = of_cameras({.backgrounds = {"lead-in:2"}, .regions = {"1,2,3,4", "-5, 6,7,8"}, .grow_px = 2}, 2);
  for (const SegmenterOptions& camera : options) {
    EXPECT_EQ(std::get<BackgroundLeadIn>(camera.background.value()).seconds, 2);
    EXPECT_EQ(camera.clean_up.grow_px, 2);
  }
  EXPECT_EQ(options[0].clean_up.region, (Box{1, 2, 3, 4}));
  EXPECT_EQ(options[1].clean_up.region, (Box{-5, 6, 7, 8}));
  EXPECT_THROW(of_cameras({.regions = {"1,2,3,4", "1,2,3,4"}}, 3), OptionError);
}

TEST(SegmentationOptions, ValuesBecomeThoseOfTheSegmenter) {
  const SegmenterOptions chroma = of_cameras({.segmenter = "chroma", .key_colour = "#00b140", .min_blob_px = 9}).at(0);
  EXPECT_EQ(chroma.key_colour, (KeyColour{0x00, 0xb1, 0x40}));
  EXPECT_EQ(chroma.clean_up.min_blob_px, 9);
  const SegmenterOptions depth =
      of_cameras({.segmenter = "depth", .depths = {"deep"}, .depth_range_m = std::array{0.5, 3.0}}).at(0);
  EXPECT_EQ(depth.depth, "deep");
  EXPECT_EQ(depth.depth_range.value().min_m, 0.5);
  EXPECT_EQ(depth.depth_range.value().max_m, 3.0);
}

TEST(SegmentationOptions, RefusesWhatNeedsAnotherSegmenter) {
  EXPECT_EQ(refusal({}), "");
  EXPECT_EQ(refusal({.key_colour = "#00b140"}), "--key-colour: needs --segmenter chroma");
  EXPECT_EQ(refusal({.depths = {"deep"}}), "--depth: needs --segmenter depth or background");
  EXPECT_EQ(refusal({.segmenter = "background", .depths = {"deep"}}), "");
  EXPECT_EQ(refusal({.segmenter = "depth"}), "--segmenter depth: needs --depth");
  EXPECT_EQ(refusal({.depth_range_m = std::array{1.0, 2.0}}), "--depth-range: needs --segmenter depth");
}

TEST(SegmentationOptions, RefusesValuesThatCannotBeUnderstood) {
  for (const char* region : {"", "1,2,3", "1,2,3,4,5", "1,2,3,4,", "a,2,3,4", "1.5,2,3,4", "1,2,0,4", "1,2,3,1e9"}) {
    EXPECT_THAT(refusal({.regions = {region}}), HasSubstr("is not x,y,w,h")) << region;
  }
  EXPECT_THAT(refusal({.segmenter = "chroma", .key_colour = "blue"}), HasSubstr("--key-colour: key colour 'blue'"));
  EXPECT_EQ(refusal({.segmenter = "depth", .depths = {"deep"}, .depth_range_m = std::array{2.0, 1.0}}),
            "--depth-range: 2,1 is not MIN,MAX");
}

using SegmentationFiles = FolderTest;

TEST_F(SegmentationFiles, GarbageMasksHaveTheSizeOfTheVideo) {
  Mask mask(32, 24);
  mask.set(3, 4, true);
  const std::string right = (folder_ / "right.png").string(), wrong = (folder_ / "wrong.png").string();
  write_mask(right, mask).value();
  write_mask(wrong, Mask(24, 32)).value();
  EXPECT_EQ(of_cameras({.garbage_masks = {right}}).at(0).clean_up.garbage_mask.value().count(), 1);
  EXPECT_THAT(segmenter_options({.garbage_masks = {wrong}}, video_of(1), "").error().message,
              HasSubstr("wrong.png: 24x32, but the video is 32x24"));
  EXPECT_FALSE(segmenter_options({.garbage_masks = {(folder_ / "absent.png").string()}}, video_of(1), "").ok());
}

TEST(SegmentationTable, HasTheDefaultsOfTheStruct) {
  GivenOptions values;
  segmentation_option_table().collect({}, values);
  EXPECT_EQ(text_of(values.at("segmenter")), "auto");
  EXPECT_EQ(text_of(values.at("grow")), "0");
  EXPECT_FALSE(values.contains("min-blob"));
  EXPECT_NO_THROW(segmentation_option_table().check({}));
}

}  // namespace
}  // namespace silpose
