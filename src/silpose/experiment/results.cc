#include "silpose/experiment/results.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "silpose/base/text_file.h"
#include "silpose/experiment/svg_plot.h"

namespace silpose {
namespace {

using Json = nlohmann::ordered_json;
constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();

bool is_of_family(const std::string& score) { return score.find('/') != std::string::npos; }

// Scores of any run that are not of a family, in alphabetical order.
std::set<std::string> plain_scores(std::span<const FinishedRun> runs) {
  std::set<std::string> names;
  for (const FinishedRun& run : runs) {
    for (const auto& [name, value] : run.result.scores) {
      if (!is_of_family(name)) names.insert(name);
    }
  }
  return names;
}

std::vector<double> scores_of_cell(std::span<const FinishedRun> runs, size_t cell, const std::string& score) {
  std::vector<double> values;
  for (const FinishedRun& run : runs) {
    const auto found = run.result.scores.find(score);
    if (run.cell_idx == cell && found != run.result.scores.end()) values.push_back(found->second);
  }
  return values;
}

Json json_of_figures(const Grid& grid, std::span<const FinishedRun> runs) {
  Json figures = Json::object();
  for (size_t cell = 0; cell < grid.cells.size(); ++cell) {
    for (const std::string& score : plain_scores(runs)) {
      const auto summary = summarise(scores_of_cell(runs, cell, score));
      if (!summary) continue;
      std::string key;
      for (const std::string& label : grid.cells[cell].labels) key += label + "/";
      figures[key + score] = {
          {"mean", summary->mean}, {"std", summary->std}, {"n", summary->n}, {"unit", unit_of(score)}};
    }
  }
  return figures;
}

Json json_of_table(const ResultTable& table) {
  Json rows = Json::array();
  for (const auto& row : table.rows) {
    Json& object = rows.emplace_back(Json::object());
    for (size_t c = 0; c < row.size(); ++c) {
      const std::string& column = table.columns[c];
      object[column] = nullptr;
      if (const auto* const text = std::get_if<std::string>(&row[c])) object[column] = *text;
      if (const auto* const number = std::get_if<double>(&row[c])) object[column] = *number;
      if (const auto* const summary = std::get_if<Summary>(&row[c])) {
        object[column] = summary->mean;
        object[column + "_std"] = summary->std;
        object[column + "_n"] = summary->n;
      }
    }
  }
  return rows;
}

std::string labels_csv(const Grid& grid, const FinishedRun& run) {
  std::string csv;
  for (const std::string& label : grid.cells[run.cell_idx].labels) csv += label + ",";
  return csv + std::to_string(run.seed);
}

std::string number_csv(double value) { return std::isfinite(value) ? fmt::format("{}", value) : ""; }

std::string axes_csv(const Grid& grid) {
  std::string csv;
  for (const GridAxis& axis : grid.axes) csv += axis.name + ",";
  return csv + "seed";
}

std::string runs_csv(const Grid& grid, std::span<const FinishedRun> runs) {
  std::set<std::string> names;
  for (const FinishedRun& run : runs) {
    for (const auto& [name, value] : run.result.scores) names.insert(name);
  }
  std::string csv = axes_csv(grid);
  for (const bool family : {false, true}) {  // families last: they are long
    for (const std::string& name : names) {
      if (is_of_family(name) == family) csv += fmt::format(",{}", name);
    }
  }
  csv += ",wall_s\n";
  for (const FinishedRun& run : runs) {
    csv += labels_csv(grid, run);
    for (const bool family : {false, true}) {
      for (const std::string& name : names) {
        if (is_of_family(name) != family) continue;
        const auto found = run.result.scores.find(name);
        csv += ",";
        if (found != run.result.scores.end()) csv += number_csv(found->second);
      }
    }
    csv += fmt::format(",{}\n", number_csv(run.result.wall_s));
  }
  return csv;
}

std::string frames_csv(const Grid& grid, std::span<const FinishedRun> runs) {
  if (runs.empty()) return axes_csv(grid) + "\n";
  const std::vector<std::string>& columns = runs[0].result.frame_columns;
  std::string csv = fmt::format("{},{}\n", axes_csv(grid), fmt::join(columns, ","));
  for (const FinishedRun& run : runs) {
    if (run.result.frame_columns != columns) continue;
    const std::string labels = labels_csv(grid, run);
    for (const std::vector<double>& row : run.result.frames) {
      csv += labels;
      for (const double value : row) csv += fmt::format(",{}", number_csv(value));
      csv += "\n";
    }
  }
  return csv;
}

std::optional<size_t> axis_of(const Grid& grid, const std::string& name) {
  for (size_t a = 0; a < grid.axes.size(); ++a) {
    if (grid.axes[a].name == name) return a;
  }
  return std::nullopt;
}

// The labels of the axis that makes the series; one empty label without it.
std::vector<std::string> series_labels(const Grid& grid, const PlotDescription& plot) {
  const auto axis = axis_of(grid, plot.series);
  return axis ? grid.axes[*axis].labels : std::vector<std::string>{""};
}

bool is_in_series(const Grid& grid, const PlotDescription& plot, const FinishedRun& run, const std::string& label) {
  const auto axis = axis_of(grid, plot.series);
  return !axis || grid.cells[run.cell_idx].labels[*axis] == label;
}

// Means of a score by the labels of an axis.
SvgSeries bar_series(const Grid& grid, const PlotDescription& plot, std::span<const FinishedRun> runs,
                     const std::string& label) {
  const size_t x_axis = *axis_of(grid, plot.x);
  SvgSeries series{.name = label, .x = {}, .y = {}};
  for (const std::string& category : grid.axes[x_axis].labels) {
    std::vector<double> values;
    for (const FinishedRun& run : runs) {
      const auto found = run.result.scores.find(plot.figure);
      if (found != run.result.scores.end() && grid.cells[run.cell_idx].labels[x_axis] == category &&
          is_in_series(grid, plot, run, label)) {
        values.push_back(found->second);
      }
    }
    const auto summary = summarise(values);
    series.y.push_back(summary ? summary->mean : kAbsent);
  }
  return series;
}

// A frame column's means over all runs that have the frame.
SvgSeries line_series(const Grid& grid, const PlotDescription& plot, std::span<const FinishedRun> runs,
                      const std::string& label) {
  std::map<double, std::vector<double>> by_frame;
  for (const FinishedRun& run : runs) {
    const std::vector<std::string>& columns = run.result.frame_columns;
    const auto column = std::find(columns.begin(), columns.end(), plot.figure);
    if (column == columns.end() || !is_in_series(grid, plot, run, label)) continue;
    for (const std::vector<double>& row : run.result.frames) {
      std::vector<double>& values = by_frame[row[0]];
      const double value = row[static_cast<size_t>(column - columns.begin())];
      if (std::isfinite(value)) values.push_back(value);
    }
  }
  SvgSeries series{.name = label, .x = {}, .y = {}};
  for (const auto& [frame, values] : by_frame) {
    const auto summary = summarise(values);
    series.x.push_back(frame);
    series.y.push_back(summary ? summary->mean : kAbsent);
  }
  return series;
}

// Columns of the main table that came from the joined CSV, in the order of the plot's categories.
void add_beside(const PlotDescription& plot, const ResultTable& table, SvgPlot& svg) {
  for (const std::string& name : plot.beside) {
    const auto column = std::find(table.columns.begin(), table.columns.end(), name);
    if (column == table.columns.end()) continue;
    SvgSeries series{.name = name, .x = {}, .y = std::vector<double>(svg.categories.size(), kAbsent)};
    for (const auto& row : table.rows) {
      const auto* const label = std::get_if<std::string>(&row[0]);
      const auto* const value = std::get_if<double>(&row[static_cast<size_t>(column - table.columns.begin())]);
      if (label == nullptr || value == nullptr) continue;
      const auto category = std::find(svg.categories.begin(), svg.categories.end(), *label);
      if (category != svg.categories.end()) series.y[static_cast<size_t>(category - svg.categories.begin())] = *value;
    }
    svg.series.push_back(std::move(series));
  }
}

std::string svg_of(const Grid& grid, const PlotDescription& plot, std::span<const FinishedRun> runs,
                   const ResultTable& main_table) {
  const std::string unit = unit_of(plot.figure);
  SvgPlot svg{.title = plot.title,
              .x_label = plot.x,
              .y_label = !plot.label.empty() ? plot.label
                         : unit == "1"       ? plot.figure
                                             : fmt::format("{} ({})", plot.figure, unit),
              .categories = {},
              .series = {}};
  const auto x_axis = axis_of(grid, plot.x);
  if (x_axis) svg.categories = grid.axes[*x_axis].labels;
  for (const std::string& label : series_labels(grid, plot)) {
    svg.series.push_back(x_axis ? bar_series(grid, plot, runs, label) : line_series(grid, plot, runs, label));
  }
  if (x_axis) add_beside(plot, main_table, svg);
  return svg_from_plot(svg);
}

}  // namespace

Result<ResultTable> write_results(const std::filesystem::path& folder, const Grid& grid,
                                  std::span<const FinishedRun> runs, const ResultFacts& facts) {
  Json json;
  json["name"] = grid.name;
  json["title"] = grid.title;
  json["command"] = facts.command;
  json["seed"] = facts.seed;
  json["seeds"] = facts.seeds;
  json["quick"] = facts.quick;
  json["commit"] = facts.commit;
  json["machine"] = facts.machine;
  double wall_s = 0;
  for (const FinishedRun& run : runs) wall_s += run.result.wall_s;
  json["wall_s"] = wall_s;
  json["runs"] = runs.size();
  json["figures"] = json_of_figures(grid, runs);
  json["tables"] = Json::object();
  std::optional<ResultTable> main_table;
  for (const TableDescription& description : grid.tables) {
    Result<ResultTable> table = make_table(grid, description, runs);
    if (!table) return table.failure();
    json["tables"][description.name] = json_of_table(*table);
    const Result<void> written = write_text_file(folder / (description.name + ".csv"), csv_from_table(*table));
    if (!written) return written.failure();
    if (!main_table) main_table = std::move(*table);
  }
  for (const PlotDescription& plot : grid.plots) {
    const Result<void> written = write_text_file(folder / (plot.name + ".svg"), svg_of(grid, plot, runs, *main_table));
    if (!written) return written.failure();
  }
  for (const auto& [name, text] : {std::pair<const char*, std::string>{"runs.csv", runs_csv(grid, runs)},
                                   {"frames.csv", frames_csv(grid, runs)},
                                   {"results.json", json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n"}}) {
    const Result<void> written = write_text_file(folder / name, text);
    if (!written) return written.failure();
  }
  return std::move(*main_table);
}

}  // namespace silpose
