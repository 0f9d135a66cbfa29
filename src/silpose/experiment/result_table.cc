#include "silpose/experiment/result_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <string_view>

#include "silpose/base/text_file.h"

namespace silpose {
namespace {

using Cell = ResultTable::Cell;
using Labels = std::vector<std::string>;

size_t axis_index(const Grid& grid, const std::string& name) {
  size_t index = 0;
  while (grid.axes[index].name != name) ++index;  // the reader has checked it
  return index;
}

// Every combination of the labels of some axes, in the grid's order; one empty combination of none.
std::vector<Labels> combinations(const Grid& grid, const std::vector<std::string>& axes) {
  std::vector<Labels> all = {{}};
  for (const std::string& axis : axes) {
    std::vector<Labels> longer;
    for (const Labels& labels : all) {
      for (const std::string& label : grid.axes[axis_index(grid, axis)].labels) {
        longer.push_back(labels);
        longer.back().push_back(label);
      }
    }
    all = std::move(longer);
  }
  return all;
}

// The runs whose cells have these labels on these axes.
std::vector<const FinishedRun*> choose(const Grid& grid, std::span<const FinishedRun* const> runs,
                                       const std::vector<std::string>& axes, const Labels& labels) {
  std::vector<const FinishedRun*> chosen;
  for (const FinishedRun* const run : runs) {
    bool fits = true;
    for (size_t a = 0; a < axes.size(); ++a) {
      fits = fits && grid.cells[run->cell_idx].labels[axis_index(grid, axes[a])] == labels[a];
    }
    if (fits) chosen.push_back(run);
  }
  return chosen;
}

std::vector<double> scores_of(std::span<const FinishedRun* const> runs, const std::string& score) {
  std::vector<double> values;
  for (const FinishedRun* const run : runs) {
    const auto found = run->result.scores.find(score);
    if (found != run->result.scores.end()) values.push_back(found->second);
  }
  return values;
}

// The median over cells of their means over seeds.
double median_over_cells(std::span<const FinishedRun* const> runs, const std::string& score) {
  std::map<size_t, std::vector<double>> cells;
  for (const FinishedRun* const run : runs) {
    const auto found = run->result.scores.find(score);
    if (found != run->result.scores.end()) cells[run->cell_idx].push_back(found->second);
  }
  std::vector<double> means;
  means.reserve(cells.size());
  for (const auto& [cell, values] : cells) means.push_back(summarise(values)->mean);
  std::sort(means.begin(), means.end());
  const size_t middle = means.size() / 2;
  return means.size() % 2 == 1 ? means[middle] : (means[middle - 1] + means[middle]) / 2;
}

struct FigureName {
  std::string score, how;  // "joint_error_mm", "max"
  [[nodiscard]] std::string column() const { return how.empty() ? score : score + "_" + how; }
};

FigureName parse_figure(const std::string& figure) {
  const size_t colon = figure.find(':');
  return {figure.substr(0, colon), colon == std::string::npos ? "" : figure.substr(colon + 1)};
}

Result<Cell> figure_of(std::span<const FinishedRun* const> runs, const FigureName& figure) {
  const std::vector<double> values = scores_of(runs, figure.score);
  const std::optional<Summary> summary = summarise(values);
  if (!summary) return Cell();
  if (figure.how.empty()) return Cell(*summary);
  if (figure.how == "max") return Cell(*std::max_element(values.begin(), values.end()));
  if (figure.how == "min") return Cell(*std::min_element(values.begin(), values.end()));
  if (figure.how == "sum") return Cell(std::accumulate(values.begin(), values.end(), 0.0));
  if (figure.how == "percent") return Cell(100 * summary->mean);
  if (figure.how == "median") return Cell(median_over_cells(runs, figure.score));
  return error("figure {}:{}: max, min, median, sum or percent", figure.score, figure.how);
}

// A CSV next to the description, as texts.
struct Beside {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};

std::vector<std::string> split(std::string_view line) {
  std::vector<std::string> fields;
  for (size_t start = 0;;) {
    const size_t comma = line.find(',', start);
    fields.emplace_back(line.substr(start, comma == std::string_view::npos ? comma : comma - start));
    if (comma == std::string_view::npos) return fields;
    start = comma + 1;
  }
}

Result<Beside> read_beside(const std::filesystem::path& file, const std::vector<std::string>& keys) {
  const Result<std::string> text = read_text_file(file);
  if (!text) return text.failure();
  Beside beside;
  size_t number = 0;
  for (size_t start = 0; start < text->size();) {
    const size_t end = std::min(text->find('\n', start), text->size());
    std::string_view line(text->data() + start, end - start);
    start = end + 1;
    ++number;
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.empty() || line.starts_with('#')) continue;
    std::vector<std::string> fields = split(line);
    if (beside.header.empty()) {
      beside.header = std::move(fields);
    } else if (fields.size() != beside.header.size()) {
      return error("{}: line {}: {} fields, not {}", file.string(), number, fields.size(), beside.header.size());
    } else {
      beside.rows.push_back(std::move(fields));
    }
  }
  for (const std::string& key : keys) {
    if (std::find(beside.header.begin(), beside.header.end(), key) == beside.header.end()) {
      return error("{}: no column '{}'", file.string(), key);
    }
  }
  return beside;
}

Cell cell_from_text(const std::string& text) {
  if (text.empty()) return {};
  double number = 0;
  const auto [end, bad] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (bad == std::errc() && end == text.data() + text.size()) return number;
  return text;
}

// Joins the columns that are no keys. The mean row gets their means.
void join(const Beside& beside, const std::vector<std::string>& keys, ResultTable& table) {
  for (size_t column = 0; column < beside.header.size(); ++column) {
    if (std::find(keys.begin(), keys.end(), beside.header[column]) != keys.end()) continue;
    table.columns.push_back(beside.header[column]);
    std::vector<double> numbers;
    for (std::vector<Cell>& row : table.rows) {
      const bool is_mean_row = std::holds_alternative<std::string>(row[0]) && std::get<std::string>(row[0]) == "mean";
      Cell cell;
      if (is_mean_row) {
        if (const auto summary = summarise(numbers)) cell = summary->mean;
      } else {
        for (const std::vector<std::string>& other : beside.rows) {
          bool same = true;
          for (size_t k = 0; k < keys.size(); ++k) {
            const auto at = std::find(beside.header.begin(), beside.header.end(), keys[k]) - beside.header.begin();
            same = same && std::get<std::string>(row[k]) == other[static_cast<size_t>(at)];
          }
          if (same) cell = cell_from_text(other[column]);
        }
        if (const double* const number = std::get_if<double>(&cell)) numbers.push_back(*number);
      }
      row.push_back(std::move(cell));
    }
  }
}

// The members of a family of scores that any run has, in alphabetical order.
std::vector<std::string> members_of(std::span<const FinishedRun* const> runs, const std::string& family) {
  std::set<std::string> members;
  for (const FinishedRun* const run : runs) {
    for (auto it = run->result.scores.lower_bound(family + "/"); it != run->result.scores.end(); ++it) {
      if (!it->first.starts_with(family + "/")) break;
      members.insert(it->first.substr(family.size() + 1));
    }
  }
  return {members.begin(), members.end()};
}

}  // namespace

std::optional<Summary> summarise(std::span<const double> values) {
  if (values.empty()) return std::nullopt;
  Summary summary;
  summary.n = static_cast<int64_t>(values.size());
  const auto n = static_cast<double>(values.size());
  summary.mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
  double squares = 0;
  for (const double value : values) squares += (value - summary.mean) * (value - summary.mean);
  summary.std = std::sqrt(squares / n);
  return summary;
}

Result<ResultTable> make_table(const Grid& grid, const TableDescription& description,
                               std::span<const FinishedRun> finished) {
  std::vector<const FinishedRun*> runs;
  runs.reserve(finished.size());
  for (const FinishedRun& run : finished) runs.push_back(&run);

  ResultTable table{.name = description.name, .title = description.title, .columns = description.rows, .rows = {}};
  const std::vector<Labels> across = combinations(grid, description.columns);
  const bool is_family = !description.family.empty();
  const std::vector<std::string> members =
      is_family ? members_of(runs, description.family) : std::vector<std::string>{""};
  const std::vector<std::string> figures = is_family ? std::vector<std::string>{""} : description.figures;
  if (is_family) table.columns.push_back(description.family);
  for (const Labels& labels : across) {
    for (const std::string& figure : figures) {
      const std::string column = is_family ? "share" : parse_figure(figure).column();
      table.columns.push_back(labels.empty() ? column : fmt::format("{}_{}", fmt::join(labels, "_"), column));
    }
  }

  const auto add_row = [&](std::span<const FinishedRun* const> row_runs, std::vector<Cell> row,
                           const std::string& member) -> Result<void> {
    for (const Labels& labels : across) {
      const auto chosen = choose(grid, row_runs, description.columns, labels);
      for (const std::string& figure : figures) {
        const FigureName name = is_family ? FigureName{description.family + "/" + member, ""} : parse_figure(figure);
        Result<Cell> cell = figure_of(chosen, name);
        if (!cell) return error("{}: table '{}': {}", grid.name, description.name, cell.error().message);
        row.push_back(std::move(*cell));
      }
    }
    table.rows.push_back(std::move(row));
    return {};
  };
  for (const Labels& labels : combinations(grid, description.rows)) {
    const auto chosen = choose(grid, runs, description.rows, labels);
    if (chosen.empty()) continue;  // all its cells are left out
    for (const std::string& member : members) {
      std::vector<Cell> row(labels.begin(), labels.end());
      if (is_family) row.emplace_back(member);
      const Result<void> added = add_row(chosen, std::move(row), member);
      if (!added) return added.failure();
    }
  }
  if (description.mean_row && !description.rows.empty() && !is_family) {
    std::vector<Cell> row(description.rows.size());
    row[0] = std::string("mean");
    const Result<void> added = add_row(runs, std::move(row), "");
    if (!added) return added.failure();
  }
  if (!description.beside.empty()) {
    const Result<Beside> beside = read_beside(grid.folder / description.beside, description.rows);
    if (!beside) return beside.failure();
    join(*beside, description.rows, table);
  }
  return table;
}

}  // namespace silpose
