#include "silpose/experiment/engine.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>

#include "silpose/base/text_file.h"

namespace silpose {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
namespace fs = std::filesystem;

Grid small_grid() {
  Grid grid;
  grid.name = "small";
  grid.axes = {{"case", {"a", "b/c"}}};
  grid.cells = {{{"a"}, {.frames = 1}}, {{"b/c"}, {.frames = 2}}};
  return grid;
}

// Scores that only the settings and the seed make.
RunResult fake_result(const RunSettings& settings, uint64_t seed) {
  RunResult run;
  run.scores = {{"joint_error_mm", settings.frames * 10 + static_cast<double>(seed) / 3}};
  run.frame_columns = {"frame", "iou"};
  run.frames = {{0, 0.1 * static_cast<double>(seed)}, {1, std::numeric_limits<double>::quiet_NaN()}};
  return run;
}

struct Counter {
  int runs = 0;
  Result<std::optional<RunResult>> operator()(const RunSettings& settings, uint64_t seed,
                                              const std::function<bool()>& go_on) {
    ++runs;
    if (!go_on()) return std::optional<RunResult>();
    return std::optional<RunResult>(fake_result(settings, seed));
  }
};

// Asks to stop at the given call.
class StopAfter : public ProgressSink {
 public:
  explicit StopAfter(int calls) : calls_(calls) {}
  bool update(std::string_view, int64_t done, int64_t total) override {
    EXPECT_LE(done, total);
    last_done = done;
    return calls_-- > 0;
  }
  int64_t last_done = 0;

 private:
  int calls_;
};

class Engine : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::path(testing::TempDir()) /
              (std::string("engine_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::vector<FinishedRun> finish(Counter& counter, ProgressSink* progress = nullptr) {
    return run_grid(small_grid(), {.first_seed = 4, .seeds = 3}, folder_, std::ref(counter), progress).value().value();
  }
  fs::path folder_;
};

void expect_same(const std::vector<FinishedRun>& a, const std::vector<FinishedRun>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].cell_idx, b[i].cell_idx);
    EXPECT_EQ(a[i].seed, b[i].seed);
    EXPECT_EQ(a[i].result.scores, b[i].result.scores);
    EXPECT_EQ(a[i].result.frame_columns, b[i].result.frame_columns);
    ASSERT_EQ(a[i].result.frames.size(), b[i].result.frames.size());
    EXPECT_EQ(a[i].result.frames[0], b[i].result.frames[0]);
    EXPECT_TRUE(std::isnan(a[i].result.frames[1][1]) && std::isnan(b[i].result.frames[1][1]));
  }
}

TEST_F(Engine, RunsEveryCellForEverySeed) {
  Counter counter;
  const std::vector<FinishedRun> runs = finish(counter);
  EXPECT_EQ(counter.runs, 6);
  ASSERT_EQ(runs.size(), 6u);
  EXPECT_EQ(runs[4].cell_idx, 1u);
  EXPECT_EQ(runs[4].seed, 5u);
  EXPECT_EQ(runs[4].result.scores.at("joint_error_mm"), 20 + 5 / 3.0);
  EXPECT_TRUE(fs::exists(folder_ / "runs" / "b-c_seed5.json"));
}

TEST_F(Engine, SkipsFinishedRunsAndDoesThoseOfOtherSettingsAnew) {
  Counter first, second;
  const auto runs = finish(first);
  expect_same(finish(second), runs);
  EXPECT_EQ(second.runs, 0);

  Grid changed = small_grid();
  changed.cells[0].settings.preset = "thesis";
  Counter third;
  ASSERT_TRUE(run_grid(changed, {.first_seed = 4, .seeds = 3}, folder_, std::ref(third)).ok());
  EXPECT_EQ(third.runs, 3);
}

TEST_F(Engine, AStoppedExperimentGoesOnToTheSameResults) {
  Counter whole_counter;
  const auto whole = finish(whole_counter);
  fs::remove_all(folder_);

  Counter counter;
  StopAfter stop(5);  // before a run and inside it: two runs are done, the third is stopped in the middle
  const auto stopped = run_grid(small_grid(), {.first_seed = 4, .seeds = 3}, folder_, std::ref(counter), &stop);
  ASSERT_TRUE(stopped.ok());
  EXPECT_FALSE(stopped->has_value());
  EXPECT_EQ(counter.runs, 3);
  EXPECT_EQ(stop.last_done, 2);

  Counter rest;
  expect_same(finish(rest), whole);
  EXPECT_EQ(rest.runs, 4);
}

TEST_F(Engine, ABrokenRunFileIsDoneAnew) {
  Counter first, second;
  (void)finish(first);
  ASSERT_TRUE(write_text_file(folder_ / "runs" / "a_seed4.json", "{\"settings\": ").ok());
  (void)finish(second);
  EXPECT_EQ(second.runs, 1);
}

TEST_F(Engine, NamesTheRunThatFails) {
  const Runner failing = [](const RunSettings& settings, uint64_t seed,
                            const std::function<bool()>&) -> Result<std::optional<RunResult>> {
    if (settings.frames == 2) return error("no such body");
    return std::optional<RunResult>(fake_result(settings, seed));
  };
  const auto runs = run_grid(small_grid(), {.first_seed = 1, .seeds = 1}, folder_, failing);
  ASSERT_FALSE(runs.ok());
  EXPECT_EQ(runs.error().message, "small: b-c_seed1: no such body");
}

TEST_F(Engine, RefusesCellsOfOneFileName) {
  Grid grid = small_grid();
  grid.cells[0].labels = {"b,c"};
  Counter counter;
  const auto runs = run_grid(grid, {}, folder_, std::ref(counter));
  ASSERT_FALSE(runs.ok());
  EXPECT_THAT(runs.error().message, HasSubstr("two cells"));
}

TEST(UnitOf, ScoreNames) {
  EXPECT_EQ(unit_of("joint_error_mm"), "mm");
  EXPECT_EQ(unit_of("joint_error_px_sd"), "px");
  EXPECT_EQ(unit_of("pose_error_npsu"), "NPSU");
  EXPECT_EQ(unit_of("frames_per_second"), "frames/s");
  EXPECT_EQ(unit_of("start_s"), "s");
  EXPECT_EQ(unit_of("iou"), "1");
}

}  // namespace
}  // namespace silpose
