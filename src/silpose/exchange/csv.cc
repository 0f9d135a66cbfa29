#include "silpose/exchange/csv.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace silpose {
namespace {

std::string_view trimmed(std::string_view text) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  return text;
}

// The whole word as a number; false where it is none.
template <class T>
bool parse(std::string_view word, T& value) {
  if (word.starts_with('+')) word.remove_prefix(1);
  const auto [end, code] = std::from_chars(word.data(), word.data() + word.size(), value);
  return code == std::errc() && end == word.data() + word.size();
}

}  // namespace

CsvReader::CsvReader(std::string file, std::string_view text) : file_(std::move(file)), rest_(text) {
  if (rest_.starts_with("\xef\xbb\xbf")) rest_.remove_prefix(3);
}

bool CsvReader::read_line() {
  while (!rest_.empty()) {
    const size_t end = std::min(rest_.find('\n'), rest_.size());
    std::string_view line = trimmed(rest_.substr(0, end));
    rest_.remove_prefix(std::min(end + 1, rest_.size()));
    ++line_;
    if (line.empty()) continue;
    fields_.clear();
    while (true) {
      const size_t comma = line.find(',');
      fields_.push_back(trimmed(line.substr(0, comma)));
      if (comma == std::string_view::npos) return true;
      line.remove_prefix(comma + 1);
    }
  }
  return false;
}

Result<std::vector<int>> CsvReader::read_header(std::span<const std::string> required,
                                                std::span<const std::string> optional) {
  if (!read_line()) return error("{}: is empty", file_);
  header_.assign(fields_.begin(), fields_.end());
  std::vector<int> columns;
  for (const auto& names : {required, optional}) {
    for (const std::string& name : names) {
      const auto found = std::find(header_.begin(), header_.end(), name);
      const bool is_there = found != header_.end();
      if (!is_there && names.data() == required.data()) return wrong("column '{}' is missing", name);
      columns.push_back(is_there ? static_cast<int>(found - header_.begin()) : -1);
    }
  }
  for (size_t k = 0; k < header_.size(); ++k) {
    if (std::find(columns.begin(), columns.end(), static_cast<int>(k)) != columns.end()) continue;
    const bool twice = std::find(header_.begin(), header_.begin() + k, header_[k]) != header_.begin() + k;
    return wrong("{} column '{}'", twice ? "a second" : "unknown", header_[k].substr(0, 40));
  }
  return columns;
}

Result<bool> CsvReader::next_row() {
  if (!read_line()) return false;
  if (fields_.size() != header_.size()) return wrong("{} fields under {} columns", fields_.size(), header_.size());
  return true;
}

Result<double> CsvReader::number(int column) const {
  double value = 0;
  if (!parse(text(column), value) || !std::isfinite(value)) {
    return wrong("{}: '{}' is not a finite number", header_[static_cast<size_t>(column)], text(column).substr(0, 40));
  }
  return value;
}

Result<int64_t> CsvReader::integer(int column) const {
  int64_t value = 0;
  if (!parse(text(column), value)) {
    return wrong("{}: '{}' is not a whole number", header_[static_cast<size_t>(column)], text(column).substr(0, 40));
  }
  return value;
}

Result<double> CsvReader::number_or(int column, double absent) const {
  if (column < 0 || text(column).empty() || text(column) == "nan" || text(column) == "NaN") return absent;
  return number(column);
}

}  // namespace silpose
