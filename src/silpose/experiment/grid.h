// Grid: an experiment as experiments/NAME.toml describes it: axes whose combinations are cells (but those left out),
// the settings of each cell, and the tables and plots to make of the scores. A new experiment of this kind is a new
// file. Threads: values; reading is without state.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/experiment/run_settings.h"

namespace silpose {

struct GridAxis {
  std::string name;
  std::vector<std::string> labels;
};

struct GridCell {
  std::vector<std::string> labels;  // one per axis
  RunSettings settings;
};

// Scores by group of runs. A figure is a score's name (its mean and deviation over the group's runs) or NAME:HOW with
// HOW one of max, min, median (over cells, of the means over seeds), sum, percent.
struct TableDescription {
  std::string name, title;
  std::vector<std::string> rows;     // axes: one row per combination of their labels
  std::vector<std::string> columns;  // axes: the figures again for each combination of theirs
  std::vector<std::string> figures;
  std::string family;     // one row also for each score "FAMILY/MEMBER", with its mean; instead of figures
  std::string beside;     // CSV next to the description: columns to join by those that are named as `rows`
  bool mean_row = false;  // a last row over all
};

// Bars: x is an axis. Lines: x is "frame", and `figure` a column of the runs' frames.
struct PlotDescription {
  std::string name, title, x, series, figure, label;
  std::vector<std::string> beside;  // of bars: columns of the first table's joined CSV, drawn too
};

struct Grid {
  std::string name, title;
  std::filesystem::path folder;  // of the description
  int seeds = 5;
  std::vector<GridAxis> axes;  // [A] outermost first
  std::vector<GridCell> cells;
  std::vector<TableDescription> tables;  // the first is the main one
  std::vector<PlotDescription> plots;
};

// With `quick` the [quick] section applies: fewer labels, frames and seeds. Errors: unreadable, not TOML, an unknown or
// malformed key; names file and key.
Result<Grid> read_grid(const std::filesystem::path& file, bool quick);

}  // namespace silpose
