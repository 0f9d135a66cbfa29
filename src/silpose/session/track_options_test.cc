#include "silpose/session/track_options.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "silpose/base/folder_for_test.h"
#include "silpose/base/option_error.h"
#include "silpose/body/test_body.h"
#include "silpose/exchange/tables.h"
#include "silpose/session/clips_of_each.h"
#include "silpose/session/session_for_test.h"

namespace silpose {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

TrackOptions options_for(std::vector<std::string> videos, const std::string& preset = "default") {
  TrackOptions options;
  options.input.videos = std::move(videos);
  options.preset = preset;
  return options;
}

template <class Call>
std::string refusal(const Call& call) {
  try {
    call();
  } catch (const OptionError& wrong) {
    return wrong.what();
  }
  return "";
}

std::string refused(const TrackOptions& options) {
  return refusal([&] { options.check(); });
}

TEST(TrackOptions, RefusesWhatDoesNotGoTogether) {
  EXPECT_EQ(refused(options_for({"a.mp4"})), "");
  EXPECT_EQ(refused(options_for({})), "VIDEO is missing");
  TrackOptions backwards = options_for({"a.mp4"});
  backwards.input.start_s = 2;
  backwards.input.end_s = 1;
  EXPECT_EQ(refused(backwards), "--start 2: is after --end 1");
  TrackOptions layers = options_for({"a.mp4"});
  layers.tracker["layers"] = int64_t{2};
  EXPECT_EQ(refused(layers), "");
  layers.fit_body = true;
  EXPECT_EQ(refused(layers), "--fit-body: not together with --layers");
  layers.fit_body.reset();
  layers.tracker["hypotheses"] = int64_t{3};
  EXPECT_THAT(refused(layers), AllOf(StartsWith("--hypotheses: "), HasSubstr("--layers")));
  TrackOptions keypoints = options_for({"a.mp4"});
  keypoints.tracker["evidence"] = std::string("landmarks");
  keypoints.fit_body = true;
  EXPECT_EQ(refused(keypoints), "--fit-body: not together with --evidence landmarks");
}

TEST(TrackOptions, LiveInputIsNeitherSmoothedNorFittedTo) {
  EXPECT_EQ(live_input({"a.mp4", "camera:1"}), "camera:1");
  EXPECT_EQ(live_input({"a.mp4"}), "");
  EXPECT_EQ(refused(options_for({"camera:0"})), "");
  EXPECT_THAT(refused(options_for({"camera:0"}, "accurate")), StartsWith("--smooth: camera:0 is live"));
  TrackOptions fits = options_for({"camera:0"});
  fits.fit_body = true;
  EXPECT_THAT(refused(fits), StartsWith("--fit-body: camera:0 is live"));
}

TEST(FitsBody, WhereRequestedAndByAccurateWhereBonesCanBeDetermined) {
  EXPECT_FALSE(fits_body(options_for({"a", "b"}), false));
  EXPECT_TRUE(fits_body(options_for({"a", "b"}, "accurate"), false));
  EXPECT_FALSE(fits_body(options_for({"a"}, "accurate"), false));
  EXPECT_TRUE(fits_body(options_for({"a"}, "accurate"), true)) << "keypoints determine bones";
  TrackOptions one = options_for({"a"});
  one.fit_body = true;
  EXPECT_THAT(refusal([&] { (void)fits_body(one, false); }), StartsWith("--fit-body: with one camera"));
  one.camera.file = "camera.toml";
  EXPECT_TRUE(fits_body(one, false)) << "the floor determines the size";
  one = options_for({"a"}, "accurate");
  one.fit_body = false;
  EXPECT_FALSE(fits_body(one, true));
}

TEST(EstimatesCamera, OfOneRecordedClipWithoutAFile) {
  EXPECT_TRUE(estimates_camera(options_for({"a.mp4"})));
  EXPECT_FALSE(estimates_camera(options_for({"a.mp4", "b.mp4"})));
  EXPECT_FALSE(estimates_camera(options_for({"camera:0"})));
  TrackOptions assumed = options_for({"a.mp4"});
  assumed.camera.file = kAssumedCamera;
  EXPECT_FALSE(estimates_camera(assumed));
}

class TrackerOfOptions : public testing::Test {
 protected:
  TrackerOptions tracker(const TrackOptions& options) {
    return tracker_options(options, std::make_shared<BodyModel>(make_test_body()), {tube_camera(0)}).value();
  }
};

TEST_F(TrackerOfOptions, HasAFloorOnlyWhereOneIsKnownOrRequested) {
  TrackOptions options = options_for({"a.mp4"});
  EXPECT_FALSE(tracker(options).has_floor());
  options.tracker["floor"] = true;
  EXPECT_TRUE(tracker(options).has_floor());
  options.tracker.clear();
  options.camera.file = "camera.toml";
  EXPECT_TRUE(tracker(options).has_floor());
}

TEST_F(TrackerOfOptions, TakesSeedAndUncertaintyOfTheSize) {
  TrackOptions options = options_for({"a.mp4"});
  options.seed = 7;
  EXPECT_EQ(tracker(options).seed, 7U);
  EXPECT_GT(tracker(options).size_deviation, 0.02);
  options.model = "human:height=1.7";
  EXPECT_EQ(tracker(options).size_deviation, 0);
}

TEST_F(TrackerOfOptions, WhatTheTrackerRejectsIsWrongUsage) {
  TrackOptions options = options_for({"a.mp4"});
  options.tracker["vertices"] = int64_t{7};
  EXPECT_THAT(refusal([&] { (void)tracker(options); }), HasSubstr("vertices: 7"));
}

TEST_F(TrackerOfOptions, EveryOptionIsWrittenDown) {
  TrackOptions options = options_for({"a.mp4"});
  options.fit_body = false;
  options.tracker["hypotheses"] = int64_t{3};
  auto chosen = chosen_options(options, tracker(options));
  EXPECT_EQ(chosen.at("hypotheses"), "3");
  EXPECT_EQ(chosen.at("floor"), "false");
  EXPECT_EQ(chosen.at("fit-body"), "false");
  EXPECT_FALSE(chosen.contains("particles"));
  options.tracker = {{"particles", int64_t{50}}};
  chosen = chosen_options(options, tracker(options));
  EXPECT_EQ(chosen.at("particles"), "50");
  EXPECT_FALSE(chosen.contains("fit-body")) << "no option of a sampling filter";
}

TEST_F(TrackerOfOptions, WhatNeedsKeypointsNamesTheSegmenterThatFindsNone) {
  TrackOptions options = options_for({"a.mp4"});
  EXPECT_TRUE(check_keypoints(options, tracker(options), "masks").ok());
  options.init = "landmarks";
  EXPECT_THAT(check_keypoints(options, tracker(options), "masks").error().message,
              StartsWith("--init landmarks: masks finds none"));
  options.init = "auto";
  options.tracker["evidence"] = std::string("landmarks");
  EXPECT_THAT(check_keypoints(options, tracker(options), "masks").error().message,
              StartsWith("--evidence landmarks: masks finds none"));
}

using InitialPose = FolderTest;

TEST_F(InitialPose, IsThatOfTheFrameOrTheFirst) {
  const BodyModel body = make_test_body();
  const auto num_dofs = static_cast<size_t>(body.skeleton.num_dofs());
  PoseTable table;
  for (const int64_t frame : {3, 4}) {
    table.rows.push_back({.frame = frame, .time_s = 0.1 * static_cast<double>(frame), .values = tube_pose(frame)});
  }
  TrackOptions options = options_for({"a.mp4"});
  EXPECT_EQ(read_initial_pose(options, body.skeleton, 3).value(), std::nullopt);
  options.init = (folder_ / "poses.csv").string();
  write_poses(options.init, body.skeleton, table).value();
  const auto first = read_initial_pose(options, body.skeleton, 0).value().value();
  ASSERT_EQ(first.size(), num_dofs);
  EXPECT_NEAR(first[5], tube_pose(3)[5], 1e-4);
  EXPECT_NEAR(read_initial_pose(options, body.skeleton, 4).value().value()[5], tube_pose(4)[5], 1e-4);
  options.init = (folder_ / "absent.csv").string();
  EXPECT_FALSE(read_initial_pose(options, body.skeleton, 0).ok());
}

class ClipsOfEach : public FolderTest {
 protected:
  static std::string refused(const TrackOptions& options) {
    return refusal([&] { (void)clips_of_each(options, "out"); });
  }
};

TEST_F(ClipsOfEach, HaveTheNamesOfTheirVideos) {
  const std::filesystem::path images = folder_ / "walk.one";
  std::filesystem::create_directories(images);
  TrackOptions options = options_for({"clips/a.mp4", images.string() + "/", "b-%03d.png"});
  options.model = "human:age=30";
  const std::vector<ClipOfEach> clips = clips_of_each(options, "out");
  ASSERT_EQ(clips.size(), 3U);
  EXPECT_EQ(clips[0].out, "out/a");
  EXPECT_EQ(clips[1].out, "out/walk.one") << "a folder keeps its name";
  EXPECT_EQ(clips[2].out, "out/b-%03d");
  EXPECT_EQ(clips[0].options.input.videos, (std::vector<std::string>{"clips/a.mp4"}));
  EXPECT_EQ(clips[2].options.model, "human:age=30");
}

TEST_F(ClipsOfEach, RefuseOneNameLiveInputAndOptionsOfOneClip) {
  EXPECT_EQ(refused(options_for({"a/x.mp4", "b/x.avi"})), "--each: a/x.mp4 and b/x.avi have one name");
  EXPECT_EQ(refused(options_for({"camera:0"})), "--each: camera:0 is live; give recorded clips");
  EXPECT_EQ(refused(options_for({".."})), "--each: .. has no name");
  TrackOptions masks = options_for({"a.mp4"}), regions = masks;
  masks.input.segmentation.masks = {"m"};
  EXPECT_THAT(refused(masks), StartsWith("--masks: belong to one clip"));
  regions.input.segmentation.regions = {"1,2,3,4", "1,2,3,4"};
  EXPECT_THAT(refused(regions), StartsWith("--region: with --each"));
}

}  // namespace
}  // namespace silpose
