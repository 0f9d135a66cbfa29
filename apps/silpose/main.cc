// silpose: the program. Parses the command line, runs one subcommand, and turns what comes back into text and an exit
// status: 0 success, 1 failure, 2 wrong usage, 130 interrupted.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <exception>

#include "apps/silpose/command.h"
#include "apps/silpose/config_file.h"
#include "apps/silpose/shared_options.h"
#include "silpose/base/option_error.h"
#include "silpose/base/parallel.h"

namespace silpose::app {
namespace {

constexpr int kSuccess = 0, kFailure = 1, kWrongUsage = 2, kInterrupted = 130;

std::string one_line(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

int fail(Console& console, bool json, const std::string& message, int status) {
  const std::string line = one_line(message);
  console.error(line);
  if (json) fmt::print("{}\n", nlohmann::json{{"error", line}}.dump());
  return status;
}

int run_command(const Command& command, const CommonOptions& common) {
  Console console;
  try {
    if (command.option_file != nullptr && !command.option_file->empty()) {
      const Result<void> applied = apply_option_file(*command.option_file, *command.app);
      if (!applied) return fail(console, common.json, applied.error().message, kFailure);
    }
    console.set_quiet(common.quiet);
    const ThreadLimit limit(common.threads);
    Console::watch_interrupts();
    const Result<Outcome> outcome = command.run(console);
    if (!outcome) {
      if (Console::interrupted()) return fail(console, common.json, "interrupted", kInterrupted);
      return fail(console, common.json, outcome.error().message, kFailure);
    }
    if (common.json) {
      fmt::print("{}\n", outcome->json.dump(2));
    } else if (!outcome->text.empty() && (!common.quiet || outcome->is_answer)) {
      fmt::print("{}\n", outcome->text);
    }
    return outcome->interrupted ? kInterrupted : outcome->failed ? kFailure : kSuccess;
  } catch (const OptionError& wrong) {
    return fail(console, common.json, wrong.what(), kWrongUsage);
  } catch (const CLI::ParseError& wrong) {  // from options that a --config file gave
    return fail(console, common.json, wrong.what(), kWrongUsage);
  } catch (const std::exception& broken) {
    return fail(console, common.json, fmt::format("internal error: {}", broken.what()), kFailure);
  }
}

int run_program(int argc, char** argv) {
  CommonOptions common;
  common.program.version = SILPOSE_VERSION;
  for (int i = 0; i < argc; ++i) common.program.command_line += (i == 0 ? "silpose" : " " + std::string(argv[i]));
  const bool json = std::any_of(argv + 1, argv + argc, [](const char* word) { return std::string(word) == "--json"; });

  CLI::App program{"Tracks the 3D pose of one person in a clip, from silhouettes.", "silpose"};
  program.set_version_flag("--version", SILPOSE_VERSION);
  program.footer(
      "SILPOSE_DATA in the environment names the folder of bodies, networks and experiments to use instead of "
      "the installed one.");
  program.require_subcommand(1);
  program.get_formatter()->column_width(34);
  std::vector<Command> commands = {add_track(program, common),     add_synth(program, common),
                                   add_evaluate(program, common),  add_segment(program, common),
                                   add_render(program, common),    add_calibrate(program, common),
                                   add_experiment(program, common)};
  for (Command& command : add_model(program, common)) commands.push_back(std::move(command));
  for (Command& command : commands) add_common_options(*command.app, common);

  try {
    program.parse(argc, argv);
  } catch (const CLI::CallForHelp& help) {
    return program.exit(help);
  } catch (const CLI::CallForAllHelp& help) {
    return program.exit(help);
  } catch (const CLI::CallForVersion& version) {
    return program.exit(version);
  } catch (const CLI::ParseError& wrong) {
    Console console;
    if (argc > 1 && argv[1][0] != '-' && program.get_subcommands().empty()) {
      return fail(console, json, fmt::format("{}: no such command; see silpose --help", argv[1]), kWrongUsage);
    }
    return fail(console, json, wrong.what(), kWrongUsage);
  }
  for (const Command& command : commands) {
    if (command.app->parsed()) return run_command(command, common);
  }
  Console console;
  return fail(console, json, "no command given; see silpose --help", kWrongUsage);
}

}  // namespace
}  // namespace silpose::app

int main(int argc, char** argv) { return silpose::app::run_program(argc, argv); }
