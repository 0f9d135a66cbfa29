// Options as a TOML file: `--config FILE.toml` reads it, and the options used are written with the result. Keys are
// option names without dashes in front; what is on the command line wins.
// Threads: the main thread only.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "silpose/base/result.h"

namespace silpose::app {

// Gives every option that the command line left alone the file's value.
// Errors: missing, not TOML, a key that is not an option; values out of range throw CLI::ValidationError.
Result<void> apply_option_file(const std::filesystem::path& file, CLI::App& command);

// Every option that is set or has a default, as key and TOML value. `chosen` overrides: option name -> value as typed.
using OptionLines = std::vector<std::pair<std::string, std::string>>;
OptionLines option_lines(const CLI::App& command, const std::map<std::string, std::string>& chosen);

// Errors: not writable.
Result<void> write_option_file(const std::filesystem::path& file, const CLI::App& command,
                               const std::map<std::string, std::string>& chosen);

}  // namespace silpose::app
