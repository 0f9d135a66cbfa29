#include "silpose/experiment/results.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "silpose/base/text_file.h"

namespace silpose {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::StartsWith;
using Json = nlohmann::json;
namespace fs = std::filesystem;

Grid walk_grid() {
  Grid grid;
  grid.name = "walks";
  grid.axes = {{"clip", {"walk", "run"}}, {"view", {"side", "front"}}};
  for (const char* clip : {"walk", "run"}) {
    for (const char* view : {"side", "front"}) grid.cells.push_back({{clip, view}, {}});
  }
  grid.tables = {{.name = "errors", .rows = {"clip", "view"}, .figures = {"joint_error_mm", "lost:sum"}}};
  return grid;
}

// Two seeds a cell: errors 10 c + 1 and 10 c + 3 of cell c; the last run of all is lost.
std::vector<FinishedRun> walk_runs() {
  std::vector<FinishedRun> runs;
  for (size_t cell = 0; cell < 4; ++cell) {
    for (uint64_t seed = 1; seed <= 2; ++seed) {
      RunResult result;
      const double error_mm = 10 * static_cast<double>(cell) + (seed == 1 ? 1 : 3);
      result.scores = {{"joint_error_mm", error_mm},
                       {"lost", cell == 3 && seed == 2 ? 1.0 : 0.0},
                       {"interval_dof/root_tx", 0.5 + 0.1 * static_cast<double>(cell)}};
      result.frame_columns = {"frame", "iou"};
      result.frames = {{0, 0.5}, {1, 0.7}};
      result.wall_s = 2;
      runs.push_back({cell, seed, result});
    }
  }
  return runs;
}

ResultTable table_of(const TableDescription& description, const Grid& grid = walk_grid()) {
  return make_table(grid, description, walk_runs()).value();
}

Summary summary_at(const ResultTable& table, size_t row, size_t column) {
  return std::get<Summary>(table.rows.at(row).at(column));
}

TEST(MakeTable, FiguresAreMeanAndPopulationDeviationOverRuns) {
  const ResultTable table = table_of(walk_grid().tables[0]);
  EXPECT_THAT(table.columns, ElementsAre("clip", "view", "joint_error_mm", "lost_sum"));
  ASSERT_EQ(table.rows.size(), 4u);
  EXPECT_EQ(std::get<std::string>(table.rows[1][1]), "front");
  EXPECT_DOUBLE_EQ(summary_at(table, 1, 2).mean, 12);
  EXPECT_DOUBLE_EQ(summary_at(table, 1, 2).std, 1);
  EXPECT_EQ(summary_at(table, 1, 2).n, 2);
  EXPECT_EQ(std::get<double>(table.rows[3][3]), 1);
}

TEST(MakeTable, OtherAxesAreTakenTogetherAndTheWorstIsFound) {
  const ResultTable table = table_of({.name = "t",
                                      .rows = {"clip"},
                                      .figures = {"joint_error_mm", "joint_error_mm:max", "joint_error_mm:median"},
                                      .mean_row = true});
  EXPECT_DOUBLE_EQ(summary_at(table, 0, 1).mean, 7);  // 1 3 11 13
  EXPECT_EQ(std::get<double>(table.rows[1][2]), 33);
  EXPECT_EQ(std::get<double>(table.rows[1][3]), 27);  // of 22 and 32
  EXPECT_EQ(std::get<std::string>(table.rows[2][0]), "mean");
  EXPECT_DOUBLE_EQ(summary_at(table, 2, 1).mean, 17);
}

TEST(MakeTable, ColumnsByAnAxisAndFamilies) {
  const ResultTable table =
      table_of({.name = "t", .rows = {"clip"}, .columns = {"view"}, .figures = {"joint_error_mm", "no_such"}});
  EXPECT_THAT(table.columns,
              ElementsAre("clip", "side_joint_error_mm", "side_no_such", "front_joint_error_mm", "front_no_such"));
  EXPECT_DOUBLE_EQ(summary_at(table, 1, 3).mean, 32);
  EXPECT_EQ(table.rows[1][4].index(), 0u);

  const ResultTable family = table_of({.name = "t", .rows = {"clip"}, .family = "interval_dof"});
  EXPECT_THAT(family.columns, ElementsAre("clip", "interval_dof", "share"));
  EXPECT_EQ(std::get<std::string>(family.rows[0][1]), "root_tx");
  EXPECT_NEAR(summary_at(family, 1, 2).mean, 0.75, 1e-12);
}

TEST(MakeTable, JoinsNumbersThatStandBeside) {
  const fs::path folder = fs::path(testing::TempDir()) / "results_beside";
  fs::create_directories(folder);
  std::ofstream(folder / "thesis.csv") << "# where from\nclip,thesis_mm,who\nrun,40.5,them\nwalk,,\n";
  std::ofstream(folder / "broken.csv") << "clip,thesis_mm\nrun\n";
  Grid grid = walk_grid();
  grid.folder = folder;
  TableDescription description{
      .name = "t", .rows = {"clip"}, .figures = {"joint_error_mm"}, .beside = "thesis.csv", .mean_row = true};
  const ResultTable table = table_of(description, grid);
  EXPECT_THAT(table.columns, ElementsAre("clip", "joint_error_mm", "thesis_mm", "who"));
  EXPECT_EQ(table.rows[0][2].index(), 0u);
  EXPECT_EQ(std::get<double>(table.rows[1][2]), 40.5);
  EXPECT_EQ(std::get<std::string>(table.rows[1][3]), "them");
  EXPECT_EQ(std::get<double>(table.rows[2][2]), 40.5);  // the mean row
  description.beside = "broken.csv";
  EXPECT_THAT(make_table(grid, description, walk_runs()).error().message, HasSubstr("line 2"));
  description.beside = "nowhere.csv";
  EXPECT_THAT(make_table(grid, description, walk_runs()).error().message, HasSubstr("nowhere.csv"));
  fs::remove_all(folder);
}

TEST(MakeTable, UnknownHowIsAnError) {
  const auto table = make_table(walk_grid(), {.name = "t", .rows = {}, .figures = {"lost:often"}}, walk_runs());
  ASSERT_FALSE(table.ok());
  EXPECT_THAT(table.error().message, HasSubstr("lost:often"));
}

TEST(ResultTableText, LinesUp) {
  ResultTable table{.name = "t", .title = "Errors", .columns = {"clip", "mm"}, .rows = {}};
  table.rows.push_back({std::string("walk"), Summary{12.345, 0.51, 5}});
  table.rows.push_back({std::string("h3d-kick"), std::monostate{}});
  EXPECT_EQ(text_from_table(table),
            "Errors\n"
            "clip               mm\n"
            "walk      12.3 ±0.510\n"
            "h3d-kick            -");
  EXPECT_EQ(csv_from_table(table), "clip,mm,mm_std\nwalk,12.345,0.51\nh3d-kick,,\n");
}

TEST(WriteResults, FilesHoldFiguresTablesAndPlots) {
  const fs::path folder = fs::path(testing::TempDir()) / "results_files";
  fs::create_directories(folder);
  Grid grid = walk_grid();
  grid.plots = {{.name = "bars", .title = "a < b", .x = "clip", .series = "view", .figure = "joint_error_mm"},
                {.name = "lines", .x = "frame", .figure = "iou"}};
  const auto written =
      write_results(folder, grid, walk_runs(),
                    {.command = "silpose experiment walks", .commit = "abc", .machine = "this", .seed = 1, .seeds = 2});
  ASSERT_TRUE(written.ok()) << written.error().message;
  const Json json = Json::parse(read_text_file(folder / "results.json").value());
  EXPECT_EQ(json["name"], "walks");
  EXPECT_EQ(json["commit"], "abc");
  EXPECT_EQ(json["wall_s"], 16);
  const Json& figure = json["figures"]["run/side/joint_error_mm"];
  EXPECT_EQ(figure["mean"], 22);
  EXPECT_EQ(figure["std"], 1);
  EXPECT_EQ(figure["n"], 2);
  EXPECT_EQ(figure["unit"], "mm");
  EXPECT_FALSE(json["figures"].contains("run/side/interval_dof/root_tx"));
  EXPECT_EQ(json["tables"]["errors"][3]["lost_sum"], 1);
  EXPECT_EQ(json["tables"]["errors"][0]["joint_error_mm_std"], 1);
  EXPECT_THAT(read_text_file(folder / "runs.csv").value(),
              StartsWith("clip,view,seed,joint_error_mm,lost,interval_dof/root_tx,wall_s\nwalk,side,1,1,0,0.5,2\n"));
  EXPECT_THAT(read_text_file(folder / "frames.csv").value(),
              StartsWith("clip,view,seed,frame,iou\nwalk,side,1,0,0.5\nwalk,side,1,1,0.7\n"));
  EXPECT_THAT(read_text_file(folder / "bars.svg").value(), HasSubstr("a &lt; b"));
  EXPECT_TRUE(fs::exists(folder / "lines.svg"));
  EXPECT_TRUE(fs::exists(folder / "errors.csv"));
  fs::remove_all(folder);
}

}  // namespace
}  // namespace silpose
