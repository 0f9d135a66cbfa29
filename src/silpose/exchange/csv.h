// CsvReader: rows of a comma-separated table with named columns in any order, as our tables are: no quotes.
// Threads: one thread per reader.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "silpose/base/result.h"

namespace silpose {

class CsvReader {
 public:
  // `text` must outlive the reader; `file` names it in errors.
  CsvReader(std::string file, std::string_view text);

  // Reads the first line. Returns the positions of the required columns, then of the optional ones: -1 where one is
  // absent.
  // Errors: an empty file; a required column is missing; a column that is neither, or there twice.
  Result<std::vector<int>> read_header(std::span<const std::string> required, std::span<const std::string> optional);

  // Goes to the next row that is not blank; false at the end. Errors: not as many fields as the header.
  Result<bool> next_row();

  // A field of the row; `column` comes from read_header. Errors: not a finite number / not a whole number.
  [[nodiscard]] std::string_view text(int column) const { return fields_[static_cast<size_t>(column)]; }
  [[nodiscard]] Result<double> number(int column) const;
  [[nodiscard]] Result<int64_t> integer(int column) const;
  // `absent` where there is no such column or the field is empty or "nan".
  [[nodiscard]] Result<double> number_or(int column, double absent) const;

  // An error that names file and line.
  template <class... Args>
  [[nodiscard]] tl::unexpected<Error> wrong(fmt::format_string<Args...> format, Args&&... args) const {
    return error("{}: line {}: {}", file_, line_, fmt::format(format, std::forward<Args>(args)...));
  }

 private:
  bool read_line();  // into fields_

  std::string file_;
  std::string_view rest_;
  int64_t line_ = 0;
  std::vector<std::string_view> fields_;
  std::vector<std::string> header_;
};

}  // namespace silpose
