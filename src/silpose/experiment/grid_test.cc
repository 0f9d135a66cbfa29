#include "silpose/experiment/grid.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>

#include "silpose/track/tracker_presets.h"

namespace silpose {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

constexpr const char* kTable = "[[table]]\nname = \"errors\"\nfigures = [\"joint_error_mm\"]\n";

Result<Grid> read(const std::string& text, bool quick = false) {
  const fs::path file = fs::path(testing::TempDir()) /
                        (std::string(testing::UnitTest::GetInstance()->current_test_info()->name()) + "_grid.toml");
  std::ofstream(file) << text;
  Result<Grid> grid = read_grid(file, quick);
  fs::remove(file);
  return grid;
}

const std::string kTwoAxes = std::string(R"(
title = "Two axes"
seeds = 3
[run]
frames = 40
motion = "sway"
[[axis]]
name = "case"
values = [{ label = "exact" }, { label = "tall", body_height = 1.05, frames = 20 }]
[[axis]]
name = "view"
key = "view"
values = ["front", "side", "45"]
[quick]
run = { frames = 5 }
axes = { view = ["side"] }
)") + kTable;

TEST(ReadGrid, MakesEveryCombinationTheLastAxisFastest) {
  const Grid grid = read(kTwoAxes).value();
  EXPECT_EQ(grid.title, "Two axes");
  EXPECT_EQ(grid.seeds, 3);
  ASSERT_EQ(grid.cells.size(), 6u);
  EXPECT_THAT(grid.cells[0].labels, ElementsAre("exact", "front"));
  EXPECT_THAT(grid.cells[1].labels, ElementsAre("exact", "side"));
  EXPECT_THAT(grid.cells[5].labels, ElementsAre("tall", "45"));
  EXPECT_EQ(grid.cells[1].settings.frames, 40);
  EXPECT_EQ(grid.cells[5].settings.frames, 20);
  EXPECT_EQ(grid.cells[5].settings.body_height, 1.05);
  EXPECT_THAT(grid.cells[5].settings.views, ElementsAre("45"));
  EXPECT_EQ(grid.cells[5].settings.motion, "sway");
}

TEST(ReadGrid, QuickKeepsTheChosenLabelsAndItsSettingsWin) {
  const Grid grid = read(kTwoAxes, true).value();
  EXPECT_EQ(grid.seeds, 1);
  ASSERT_EQ(grid.cells.size(), 2u);
  EXPECT_THAT(grid.cells[1].labels, ElementsAre("tall", "side"));
  EXPECT_EQ(grid.cells[1].settings.frames, 5);
}

TEST(ReadGrid, WithoutAxesThereIsOneCell) {
  const Grid grid = read(kTable).value();
  ASSERT_EQ(grid.cells.size(), 1u);
  EXPECT_EQ(grid.cells[0].settings, RunSettings());
}

// Two recorded clips, and a method that is of the first alone.
const std::string kClips = std::string(R"(
[run]
camera = "cameras.toml"
[[axis]]
name = "clip"
values = [{ label = "one", clip = ["a.mp4"], camera_names = ["a"], truth = "a", background = ["a.jpg"] },
          { label = "two", clip = ["a.mp4", "b.mp4"], truth = "b", frames = 7 }]
[[axis]]
name = "method"
values = [{ label = "both" }, { label = "network", kind = "keypoints" }]
[[without]]
clip = ["two"]
method = ["network"]
[quick]
axes = { clip = ["two"], method = ["both"] }
)") + kTable;

TEST(ReadGrid, RecordedClipsWithoutTheCellsLeftOut) {
  const Grid grid = read(kClips).value();
  ASSERT_EQ(grid.cells.size(), 3u);
  EXPECT_THAT(grid.cells[1].labels, ElementsAre("one", "network"));
  EXPECT_THAT(grid.cells[2].labels, ElementsAre("two", "both"));
  EXPECT_TRUE(grid.cells[2].settings.is_recorded());
  EXPECT_THAT(grid.cells[2].settings.clip, ElementsAre("a.mp4", "b.mp4"));
  EXPECT_THAT(grid.cells[0].settings.camera_names, ElementsAre("a"));
  EXPECT_THAT(grid.cells[0].settings.background, ElementsAre("a.jpg"));
  EXPECT_EQ(grid.cells[0].settings.segmenter, "learned");
  EXPECT_EQ(grid.cells[0].settings.run_kind(), RunKind::kTrackClip);
  EXPECT_EQ(grid.cells[1].settings.run_kind(), RunKind::kKeypoints);
  EXPECT_EQ(grid.cells[2].settings.frames, 7);
  EXPECT_EQ(read(kClips, true).value().cells.size(), 1u);
}

// Every option of the tracker can be named, "motion" with its prefix: without it is the subject's.
TEST(ReadGrid, CellsNameOptionsOfTheTracker) {
  const Grid grid = read(std::string(R"(
[run]
preset = "thesis"
motion = "sway"
tracker_motion = "first-order-augmented"
resample_below = 0.5
tracker_regenerate_from = "random"
floor = false
[[axis]]
name = "sigma"
key = "sigma_deg"
values = [2, 4.5]
[[axis]]
name = "metric"
key = "metric"
values = ["pixel-count", "coverage"]
)") + kTable)
                        .value();
  ASSERT_EQ(grid.cells.size(), 4u);
  EXPECT_EQ(grid.cells[3].settings.motion, "sway");
  EXPECT_EQ(grid.cells[3].settings.run_kind(), RunKind::kTrack);
  const GivenOptions expected = {{"motion", std::string("first-order-augmented")},
                                 {"resample-below", 0.5},
                                 {"regenerate-from", std::string("random")},
                                 {"floor", false},
                                 {"sigma-deg", 4.5},
                                 {"metric", std::string("coverage")}};
  EXPECT_EQ(grid.cells[3].settings.tracker, expected);
  EXPECT_EQ(grid.cells[0].settings.tracker.at("sigma-deg"), OptionValue(2.0)) << "a whole number is a number";
}

TEST(RunSettings, EveryOptionOfTheTrackerHasAKey) {
  const auto expect_key = [](const OptionInfo& info) {
    for (const std::string& key :
         {with_underscores(info.name), fmt::format("tracker_{}", with_underscores(info.name))}) {
      const OptionInfo* const found = tracker_option_of(key);
      ASSERT_NE(found, nullptr) << key;
      EXPECT_EQ(found->name, info.name);
    }
  };
  for (const auto& option : tracker_option_table().options) expect_key(option.info);
  for (const auto& option : fitted_option_table().options) expect_key(option.info);
  for (const auto& option : sampling_option_table().options) expect_key(option.info);
  EXPECT_EQ(tracker_option_of("speed"), nullptr);
}

struct BadGrid {
  std::string text, says;
};

const std::string kViewAxis = "[[axis]]\nname = \"view\"\n";

std::vector<BadGrid> bad_grids() {
  const std::string& axis = kViewAxis;
  return {
      {"run = { frames = -3 }\n", "run.frames: -3 is not a whole number from 0 to 1000000"},
      {"run = { frames = 2.5 }\n", "run.frames: 2.5 is not a whole number"},
      {"run = { fps = \"fast\" }\n", "run.fps: 'fast' is not a number from 0.1 to 10000"},
      {"run = { speed = 3 }\n", "run.speed: no such setting"},
      {"run = { preset = \"best\" }\n", "run.preset: 'best' is not one of default, accurate, thesis"},
      {"run = { views = \"front\" }\n", "run.views: 'front' is not a list of texts"},
      {"run = { size = [640] }\n", "run.size: a list of texts or two numbers"},
      {"run = 3\n", "run: a table"},
      {"sedes = 3\n", "sedes: no such key"},
      {"seeds = 0\n", "seeds: a whole number"},
      {"title = 3\n", "title: a text"},
      {"axis = 3\n", "axis: [[axis]] is wanted"},
      {"[[axis]]\nvalues = [1]\n", "axis.name: is missing"},
      {axis, "axis 'view'.values: a list"},
      {axis + "values = [\"front\"]\n", "axis 'view'.values: tables with a label"},
      {axis + "values = [{ view = \"front\" }]\n", "axis 'view'.values: each needs a label"},
      {axis + "key = \"view\"\nvalues = [\"side\", \"side\"]\n", "'side' is there twice"},
      {axis + "values = [{ label = \"a,b\" }]\n", "'a,b' is no label"},
      {axis + "key = \"sight\"\nvalues = [\"side\"]\n", "sight: no such setting"},
      {axis + "key = \"view\"\nvalues = [\"side\"]\n[[table]]\nname = \"t\"\nrows = [\"clip\"]\nfigures = [\"iou\"]\n",
       "table.rows: no axis 'clip'"},
      {"[[table]]\nfigures = [\"iou\"]\n", "table.name: is missing"},
      {"[[table]]\nname = \"runs\"\nfigures = [\"iou\"]\n", "'runs' is the name of another file"},
      {"[[table]]\nname = \"t\"\n", "either figures or family"},
      {"[[table]]\nname = \"t\"\nfigures = [\"iou\"]\nsort = true\n", "table.sort: no such key"},
      {"[[plot]]\nname = \"p\"\nx = \"frame\"\n", "plot.figure: is missing"},
      {"[[plot]]\nname = \"p\"\nx = \"clip\"\nfigure = \"iou\"\n", "no axis 'clip'"},
      {"seeds = = 3\n", "line 1"},
      {"without = 3\n", "without: [[without]] is wanted"},
      {"[[without]]\n", "without: names no axis"},
      {"[[without]]\nclip = [\"a\"]\n", "without.clip: no such axis"},
      {axis + "key = \"view\"\nvalues = [\"side\"]\n[[without]]\nview = [\"front\"]\n", "the axis has no 'front'"},
      {axis + "key = \"view\"\nvalues = [\"side\"]\n[[without]]\nview = [\"side\"]\n", "without: leaves no cell"},
  };
}

std::vector<BadGrid> bad_runs() {
  const auto clip = [](const std::string& more, bool names_one = true) {
    return fmt::format("run = {{ camera = \"c.toml\", truth = \"t\", {}{} }}\n",
                       names_one ? "clip = [\"a.mp4\"], " : "", more);
  };
  return {
      {"run = { truth = \"a\" }\n", "run.truth: needs clip"},
      {"run = { clip = [] }\n", "run.clip: needs clip, a list of videos"},
      {"run = { clip = \"a.mp4\" }\n", "run.clip: 'a.mp4' is not a list of texts"},
      {"run = { clip = [\"a.mp4\"] }\n", "run.clip: needs camera"},
      {"run = { clip = [\"a.mp4\"], camera = \"c.toml\" }\n", "run.clip: needs truth"},
      {clip("motion = \"sway\""), "run.motion: not together with clip"},
      {clip("mask_noise = \"none\""), "run.mask_noise: not together with clip"},
      {clip("camera_names = [\"a\", \"b\"]"), "run.clip: 2 camera_names for 1 videos"},
      {clip("background = [\"a\", \"b\"]"), "run.clip: 2 backgrounds for 1 videos"},
      {clip("evidence = \"guess\""), "run.evidence: 'guess' is not one of"},
      {clip("segmenter = \"masks\", evidence = \"landmarks\""), "evidence = \"landmarks\" needs segmenter"},
      {clip("clip = [\"a\", \"b\"], kind = \"keypoints\"", false), "run.kind: keypoints is of one video"},
      {clip("segmenter = \"masks\", kind = \"keypoints\""), "run.kind: keypoints needs segmenter"},
      {clip("kind = \"track\""), "run.kind: track is of rendered sequences"},
      {"run = { kind = \"track-clip\" }\n", "run.kind: needs clip, a list of videos"},
      {"run = { kind = \"metric\" }\n", "run.kind: 'metric' is not one of track, track-clip, keypoints"},
      {"run = { evidence = \"both\" }\n", "run.evidence: needs clip, a list of videos, or keypoints = true"},
      {"run = { fit_body = true, keypoints = true, evidence = \"landmarks\" }\n", "run.fit_body: needs silhouettes"},
      {"run = { metric = \"beauty\", preset = \"thesis\" }\n", "run.metric: 'beauty' is not one of pixel-count"},
      {"run = { sigma_deg = 100, layers = 2 }\n", "run.sigma_deg: 100 is not a number from 0.001 to 90"},
      {"run = { hypotheses = 2, particles = 50 }\n", "run.hypotheses: not together with particles"},
      {"run = { tracker_motion = \"diffusion\" }\n", "run.tracker_motion: needs particles, layers or preset thesis"},
      {"run = { root = \"fixed\" }\n", "run.root: needs particles, layers or preset thesis"},
  };
}

TEST(ReadGrid, SaysOneLineThatNamesFileAndKey) {
  std::vector<BadGrid> all = bad_grids();
  std::ranges::move(bad_runs(), std::back_inserter(all));
  for (const BadGrid& bad : all) {
    const bool has_table = bad.text.find("[[table]]") != std::string::npos;
    const Result<Grid> grid = read(bad.text + (has_table ? "" : kTable));
    ASSERT_FALSE(grid.ok()) << bad.text;
    EXPECT_THAT(grid.error().message, AllOf(HasSubstr("_grid.toml"), HasSubstr(bad.says), Not(HasSubstr("\n"))))
        << bad.text;
  }
  EXPECT_THAT(read("title = \"none\"\n").error().message, HasSubstr("table: at least one"));
  EXPECT_THAT(read(std::string("[quick]\naxes = { view = [\"side\"] }\n") + kTable, true).error().message,
              HasSubstr("quick.axes.view: no such axis"));
  EXPECT_THAT(read_grid("/nowhere/x.toml", false).error().message, HasSubstr("/nowhere/x.toml"));
}

TEST(RunSettings, TextTellsEverySettingApart) {
  const std::string plain = settings_text({});
  EXPECT_NE(settings_text({.frames = 3}), plain);
  EXPECT_NE(settings_text({.range = std::array<double, 2>{0, 1}}), plain);
  EXPECT_NE(settings_text({.tracker = {{"smooth", false}}}), plain);
  EXPECT_NE(settings_text({.tracker = {{"smooth", true}}}), settings_text({.tracker = {{"smooth", false}}}));
  EXPECT_NE(settings_text({.kind = RunKind::kTrack}), plain);
  EXPECT_NE(sequence_text({.frames = 3}), sequence_text({}));
  EXPECT_NE(sequence_text({.mask_iou = 0.5}), sequence_text({}));
  EXPECT_EQ(sequence_text({.preset = "thesis", .body_height = 1.1}), sequence_text({})) << "it looks the same";
  EXPECT_NE(settings_text({.body_weight = 1.15}), plain);
  EXPECT_EQ(settings_text({}), plain);
  const std::string clip = settings_text({.clip = {"a.mp4"}});
  EXPECT_NE(clip, plain);
  EXPECT_NE(settings_text({.clip = {"b.mp4"}}), clip);
  EXPECT_NE(settings_text({.kind = RunKind::kKeypoints, .clip = {"a.mp4"}}), clip);
  EXPECT_NE(settings_text({.tracker = {{"floor", false}}, .clip = {"a.mp4"}}), clip);
  EXPECT_TRUE(is_motion_file("cmu_bvh/02_01_walk.bvh"));
  EXPECT_FALSE(is_motion_file("dof:6"));
}

}  // namespace
}  // namespace silpose
