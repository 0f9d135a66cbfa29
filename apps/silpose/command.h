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
#include <string>
#include <vector>

#include "apps/silpose/console.h"
#include "silpose/base/result.h"
#include "silpose/session/run_context.h"

namespace silpose::app {

struct CommonOptions {
  ProgramRun program;  // with --seed
  int threads = 0;     // 0: all cores
  bool quiet = false;
  bool json = false;
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

Command add_track(CLI::App& program, const CommonOptions& common);
Command add_synth(CLI::App& program, const CommonOptions& common);
Command add_evaluate(CLI::App& program, const CommonOptions& common);
Command add_segment(CLI::App& program, const CommonOptions& common);
Command add_render(CLI::App& program, const CommonOptions& common);
Command add_calibrate(CLI::App& program, const CommonOptions& common);
Command add_experiment(CLI::App& program, const CommonOptions& common);
std::vector<Command> add_model(CLI::App& program, const CommonOptions& common);
Command add_model_fit(CLI::App& model, const CommonOptions& common);

// What the library is given of the console: progress, messages, and where data lie.
RunContext context_of(Console& console);

// A check for options: a finite number from `low` to `high`, both included.
CLI::Validator within(double low, double high);

// "640x480". Errors: throws OptionError for another form, and outside 16 to 8192.
struct Size {
  int width = 0, height = 0;
};
Size parse_size(const std::string& option, const std::string& text);

}  // namespace silpose::app
