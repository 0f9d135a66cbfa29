// What every subcommand is made of: its options on the command line, and the work behind them.
// A subcommand's file offers one function that adds it to the program and returns its Command.
// Threads: the main thread only.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "apps/silpose/console.h"
#include "silpose/base/result.h"

namespace silpose::app {

// Wrong usage found only when options are put together: exit 2. The message names the option.
struct UsageError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

struct CommonOptions {
  uint64_t seed = 1;
  int threads = 0;  // 0: all cores
  bool quiet = false;
  bool json = false;
  std::string command_line;  // as typed
};

struct Outcome {
  nlohmann::ordered_json json;  // what --json prints
  std::string text;             // what is printed otherwise, without the last newline
  bool interrupted = false;     // exit 130
  bool failed = false;          // exit 1: part of the work failed, reported as an error already
  bool is_answer = false;       // the text is the requested output: printed with --quiet too
};

struct Command {
  CLI::App* app = nullptr;
  std::function<Result<Outcome>(Console&)> run;
  const std::string* option_file = nullptr;  // --config, where the command has it
};

// --seed, --threads, --quiet, --json and --help.
void add_common_options(CLI::App& command, CommonOptions& common);

Command add_track(CLI::App& program, const CommonOptions& common);
Command add_synth(CLI::App& program, const CommonOptions& common);
Command add_evaluate(CLI::App& program, const CommonOptions& common);
Command add_segment(CLI::App& program, const CommonOptions& common);
Command add_render(CLI::App& program, const CommonOptions& common);
Command add_calibrate(CLI::App& program, const CommonOptions& common);
Command add_experiment(CLI::App& program, const CommonOptions& common);
std::vector<Command> add_model(CLI::App& program, CommonOptions& common);

// A check for options: a finite number from `low` to `high`, both included.
CLI::Validator within(double low, double high);

// "640x480". Errors: not of that form, outside 16 to 8192.
struct Size {
  int width = 0, height = 0;
};
Size parse_size(const std::string& option, const std::string& text);  // throws UsageError

// The numbers of "x,y,w,h". Errors: throws UsageError when there are not `count` of them.
std::vector<double> parse_numbers(const std::string& option, const std::string& text, size_t count);

}  // namespace silpose::app
