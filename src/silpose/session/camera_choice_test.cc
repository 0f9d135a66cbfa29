#include "silpose/session/camera_choice.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "silpose/base/folder_for_test.h"
#include "silpose/base/option_error.h"
#include "silpose/session/session_for_test.h"

namespace silpose {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::vector<ImageSize> kOne = {{160, 120}}, kTwo = {{160, 120}, {160, 120}};

std::vector<std::string> names(const CameraChoice& choice) {
  std::vector<std::string> names;
  for (const PinholeCamera& camera : choice.cameras) names.push_back(camera.name);
  return names;
}

TEST(AssumedCamera, IsLevelAndAsWideAsPhonesAre) {
  const CameraChoice choice = choose_cameras({}, {{640, 480}}).value();
  ASSERT_EQ(choice.cameras.size(), 1U);
  EXPECT_EQ(choice.cameras[0].fx, 480);
  EXPECT_NEAR(choice.cameras[0].centre_in_world().y(), 1.5, 1e-9);
  EXPECT_EQ(choice.focal.value().from, "assumed");
  EXPECT_THAT(choice.warnings, ElementsAre(HasSubstr("focal length 480 ± 96 px (typical of phones and webcams)")));
  EXPECT_FALSE(choice.estimate.has_value());
}

TEST(AssumedCamera, TakesTheFocalLengthOfTheOptionBeforeThatOfTheClip) {
  const std::vector<ImageSize> sizes = {{640, 480, 26}};
  const CameraChoice metadata = choose_cameras({.file = kAssumedCamera}, sizes).value();
  EXPECT_EQ(metadata.focal.value().from, "metadata");
  EXPECT_GT(metadata.focal.value().prior.deviation, 0);
  const CameraChoice option = choose_cameras({.fov_deg = 90}, sizes).value();
  EXPECT_NEAR(option.cameras[0].fx, 320, 1e-9);
  EXPECT_EQ(focal_px(option.focal.value().prior).deviation, 0);
  EXPECT_THAT(option.warnings, ElementsAre(HasSubstr("focal length 320 px (--fov-deg)")));
}

TEST(AssumedCamera, RefusesWhatNeedsAFile) {
  EXPECT_THROW((void)choose_cameras({.names = {"left"}}, kOne), OptionError);
  EXPECT_THROW((void)choose_cameras({}, kTwo), OptionError);
  EXPECT_THROW((void)choose_cameras({.focal_mm35 = 26, .fov_deg = 90}, kOne), OptionError);
  EXPECT_THROW((void)choose_cameras({}, {}), std::invalid_argument);
}

class CameraFile : public FolderTest {
 protected:
  CameraFile() { write_cameras(file_, {tube_camera(0), tube_camera(1)}).value(); }
  std::string refusal(const CameraOptions& options, const std::vector<ImageSize>& sizes) {
    return choose_cameras(options, sizes).error().message;
  }
  const std::string file_ = (folder_ / "camera.toml").string();
};

TEST_F(CameraFile, GivesAllItsCamerasInOrderOrThoseNamed) {
  const CameraChoice all = choose_cameras({.file = file_}, kTwo).value();
  EXPECT_THAT(names(all), ElementsAre("front", "side"));
  EXPECT_THAT(all.warnings, IsEmpty());
  EXPECT_FALSE(all.focal.has_value());
  EXPECT_THAT(names(choose_cameras({.file = file_, .names = {"side", "front"}}, kTwo).value()),
              ElementsAre("side", "front"));
  EXPECT_THAT(names(choose_cameras({.file = file_, .names = {"side"}}, kOne).value()), ElementsAre("side"));
  EXPECT_THAT(names(choose_cameras({.file = file_}, {}).value()), ElementsAre("front", "side"));
}

TEST_F(CameraFile, AxisAndUnitOfTheOptionsOverrideThoseOfTheFile) {
  const CameraChoice metres = choose_cameras({.file = file_}, kTwo).value();
  const CameraChoice mm = choose_cameras({.file = file_, .metres_per_unit = 1e-3}, kTwo).value();
  EXPECT_TRUE(mm.cameras[0].centre_in_world().isApprox(1e-3 * metres.cameras[0].centre_in_world(), 1e-6));
}

TEST_F(CameraFile, RefusalsNameTheFile) {
  EXPECT_THAT(refusal({.file = file_, .names = {"nobody"}}, kOne),
              HasSubstr("camera.toml: no camera nobody (there are front, side)"));
  EXPECT_THAT(refusal({.file = file_}, kOne), HasSubstr("2 cameras (front, side) for 1 videos"));
  EXPECT_THAT(refusal({.file = file_}, {{160, 120}, {320, 240}}),
              HasSubstr("camera side is calibrated for 160x120, the video is 320x240"));
  EXPECT_THAT(refusal({.file = (folder_ / "absent.toml").string()}, kOne), HasSubstr("absent.toml"));
  EXPECT_THAT(refusal({.file = kAssumedCamera}, {}), HasSubstr("assumed"));
  EXPECT_THROW((void)choose_cameras({.file = file_, .fov_deg = 90}, kTwo), OptionError);
}

TEST(EstimatedCamera, StaysAssumedWhereTheClipShowsTooLittle) {
  std::vector<std::unique_ptr<FrameSource>> sources;
  sources.push_back(std::make_unique<TubeSource>(TubeSource::Options{.num_frames = 3}, std::make_shared<PassCounts>()));
  SourceOptions masks;
  masks.segmenters[0].kind = "masks";
  const auto source = ObservationSource::open(join_sources(std::move(sources)).value(), masks).value();
  CameraChoice choice = choose_cameras({}, sizes_of(source->video())).value();
  ASSERT_TRUE(estimate_camera_of(*source, 1.7, choice, {}).ok());
  EXPECT_FALSE(choice.estimate.has_value());
  EXPECT_THAT(choice.warnings, ElementsAre(HasSubstr("no camera file"), HasSubstr("the camera was not estimated")));
  EXPECT_TRUE(source->next().value().has_value()) << "the source is rewound";

  StoppingProgress stop("estimating the camera", 0);
  EXPECT_THAT(estimate_camera_of(*source, 1.7, choice, {.data = {}, .progress = &stop, .message = {}}).error().message,
              HasSubstr("interrupted"));
}

TEST(CameraTables, ReadWordsAsWhatTheyMean) {
  CameraOptions options;
  GivenOptions given;
  for (const auto& [name, text] :
       std::map<std::string, std::string>{{"camera-up", "z"}, {"camera-unit", "mm"}, {"camera", "c.toml"}}) {
    given[name] = parse_option(camera_option_table().find(name)->info, text).value();
  }
  camera_option_table().apply(given, options);
  EXPECT_EQ(options.up, UpAxis::kZ);
  EXPECT_EQ(options.metres_per_unit, 1e-3);
  EXPECT_TRUE(options.has_file());
  EXPECT_FALSE(parse_option(focal_option_table().find("fov-deg")->info, "200").ok());
}

}  // namespace
}  // namespace silpose
