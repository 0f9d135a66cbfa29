// Option files of commands: --config reads one, and config.toml with a result is one. Keys are option names without
// dashes in front; what is on the command line wins.
// Threads: the main thread only.
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <map>
#include <string>

#include "apps/silpose/command.h"
#include "silpose/base/option_file.h"
#include "silpose/base/result.h"
#include "silpose/session/result_directory.h"

namespace silpose::app {

void add_config_option(CLI::App& command, std::string& file);

// Gives every option that the command line left alone the file's value.
// Errors: those of read_option_file(); a key that is not an option. Values out of range throw CLI::ValidationError.
Result<void> apply_option_file(const std::filesystem::path& file, CLI::App& command);

// Every option that is set or has a default. `chosen` overrides: option name -> value as typed.
OptionLines option_lines(const CLI::App& command, const std::map<std::string, std::string>& chosen);

// Ends a command that makes a directory (finish_result()), with a message where it was interrupted.
Result<Outcome> deliver(ResultDirectory& directory, const CLI::App& command,
                        const std::map<std::string, std::string>& chosen, Outcome outcome, Console& console);

}  // namespace silpose::app
