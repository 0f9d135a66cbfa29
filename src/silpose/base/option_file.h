// Options as a TOML file: `--config FILE.toml` reads one, and the options used are written with a result. Keys are
// option names without dashes in front.
// Threads: functions without state; two writers of one path are the caller's business.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "silpose/base/result.h"

namespace silpose {

// An option of a file, and its values as text that a command line would have: one, or those of a list.
struct FileOption {
  std::string name;
  std::vector<std::string> values;
};

// Sorted by name. Errors: missing; not TOML, with the line; a value that is neither a text, a number, a boolean nor a
// list of these, with its key.
Result<std::vector<FileOption>> read_option_file(const std::filesystem::path& file);

// Option names, each with a value as TOML, in the order of the file.
using OptionLines = std::vector<std::pair<std::string, std::string>>;

// A value of a command line as TOML: a bare number or boolean where it reads as one, otherwise a quoted text.
std::string toml_value(const std::string& text);
std::string toml_list(const std::vector<std::string>& texts);

// `command`: whose options they are, for the comment in the first line. Errors: not writable.
Result<void> write_option_file(const std::filesystem::path& file, std::string_view command, const OptionLines& lines);

}  // namespace silpose
