#include <algorithm>
#include <cmath>

#include "silpose/experiment/result_table.h"

namespace silpose {
namespace {

using Cell = ResultTable::Cell;

std::string number_text(double value) {
  if (value == std::round(value) && std::abs(value) < 1e6) return fmt::format("{:.0f}", value);
  const double size = std::abs(value);
  return fmt::format("{:.{}f}", value, size >= 100 ? 0 : size >= 10 ? 1 : size >= 1 ? 2 : 3);
}

std::string cell_text(const Cell& cell) {
  if (const auto* const text = std::get_if<std::string>(&cell)) return *text;
  if (const auto* const number = std::get_if<double>(&cell)) return number_text(*number);
  if (const auto* const summary = std::get_if<Summary>(&cell)) {
    if (summary->n == 1) return number_text(summary->mean);
    return fmt::format("{} ±{}", number_text(summary->mean), number_text(summary->std));
  }
  return "-";
}

// Characters of UTF-8 text.
size_t width_of(const std::string& text) {
  return static_cast<size_t>(std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

}  // namespace

std::string text_from_table(const ResultTable& table) {
  std::vector<size_t> shown;
  for (size_t c = 0; c < table.columns.size(); ++c) {
    if (!table.columns[c].ends_with("_sd")) shown.push_back(c);
  }
  std::vector<std::vector<std::string>> lines(table.rows.size() + 1);
  std::vector<size_t> widths;
  std::vector<bool> is_text;
  for (const size_t c : shown) {
    lines[0].push_back(table.columns[c]);
    widths.push_back(width_of(table.columns[c]));
    is_text.push_back(true);
    for (size_t r = 0; r < table.rows.size(); ++r) {
      const Cell& cell = table.rows[r][c];
      lines[r + 1].push_back(cell_text(cell));
      widths.back() = std::max(widths.back(), width_of(lines[r + 1].back()));
      is_text.back() = is_text.back() && (cell.index() == 0 || std::holds_alternative<std::string>(cell));
    }
  }
  std::string text = table.title;
  for (const std::vector<std::string>& line : lines) {
    std::string padded;
    for (size_t i = 0; i < line.size(); ++i) {
      const std::string blanks(widths[i] - width_of(line[i]), ' ');
      if (i > 0) padded += "  ";
      padded += is_text[i] ? line[i] + blanks : blanks + line[i];
    }
    padded.erase(padded.find_last_not_of(' ') + 1);
    if (!text.empty()) text += "\n";
    text += padded;
  }
  return text;
}

std::string csv_from_table(const ResultTable& table) {
  const auto has_summary = [&](size_t column) {
    return std::any_of(table.rows.begin(), table.rows.end(),
                       [&](const auto& row) { return std::holds_alternative<Summary>(row[column]); });
  };
  std::vector<bool> summaries;
  std::string csv;
  for (size_t c = 0; c < table.columns.size(); ++c) {
    summaries.push_back(has_summary(c));
    csv += (c > 0 ? "," : "") + table.columns[c];
    if (summaries[c]) csv += fmt::format(",{}_std", table.columns[c]);
  }
  csv += "\n";
  for (const auto& row : table.rows) {
    for (size_t c = 0; c < row.size(); ++c) {
      if (c > 0) csv += ",";
      if (const auto* const text = std::get_if<std::string>(&row[c])) csv += *text;
      if (const auto* const number = std::get_if<double>(&row[c])) csv += fmt::format("{}", *number);
      if (const auto* const summary = std::get_if<Summary>(&row[c])) {
        csv += fmt::format("{},{}", summary->mean, summary->std);
      } else if (summaries[c]) {
        csv += ",";
      }
    }
    csv += "\n";
  }
  return csv;
}

}  // namespace silpose
