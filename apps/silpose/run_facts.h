// run.json and config.toml: what was run and its outcome, in every result directory.
// Threads: the main thread only.
#pragma once

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "apps/silpose/command.h"
#include "apps/silpose/console.h"
#include "silpose/base/result.h"
#include "silpose/session/result_directory.h"

namespace silpose::app {

// version, command, seed, machine: how every run.json begins.
nlohmann::ordered_json run_facts(const CommonOptions& common);

// A mean and its standard deviation, {"mean", "std"}; null where the mean is NaN.
nlohmann::ordered_json figure(double mean, double std);

// "AMD EPYC 7B13, 2 threads, Linux 6.1.0": the processor and system that results were made on.
std::string machine_name();

// How a command that makes a directory ends: writes config.toml (write_option_file()) and run.json, and renames the
// directory to its final name, or leaves DIR.partial, with a message, where the work was interrupted.
// Errors: not writable, cannot be renamed.
Result<Outcome> deliver(ResultDirectory& directory, const CLI::App& command,
                        const std::map<std::string, std::string>& chosen, Outcome outcome, Console& console);

}  // namespace silpose::app
