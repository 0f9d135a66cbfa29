// ResultTable: scores of many runs grouped by axes, and the forms it is written in.
// Threads: values and functions without state.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/experiment/engine.h"
#include "silpose/experiment/grid.h"

namespace silpose {

// What numbers have in common: population deviation; n of them.
struct Summary {
  double mean = 0, std = 0;
  int64_t n = 0;
};
std::optional<Summary> summarise(std::span<const double> values);  // nothing of nothing

struct ResultTable {
  using Cell = std::variant<std::monostate, std::string, Summary, double>;  // nothing, text, mean and std, one number
  std::string name, title;
  std::vector<std::string> columns;
  std::vector<std::vector<Cell>> rows;  // [R][columns]
};

// Errors: a figure that says :HOW and HOW is not known; a CSV next to the description that is missing or malformed.
Result<ResultTable> make_table(const Grid& grid, const TableDescription& description,
                               std::span<const FinishedRun> runs);

// Columns line up; "12.3 ±0.4"; "-" where there is nothing. Deviations over frames (NAME_sd) are left out: the files
// have them. Without a last newline.
std::string text_from_table(const ResultTable& table);

// A summary is two columns, NAME and NAME_std.
std::string csv_from_table(const ResultTable& table);

}  // namespace silpose
