#include "apps/silpose/config_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

#include "silpose/session/run_facts.h"

namespace silpose::app {
namespace {

// Options of the run rather than of the method: not for a file to start other runs from. What --iou chose is kept as
// vertices.
constexpr std::array<std::string_view, 9> kNotKept = {"help", "config",  "iou",  "json",  "quiet",
                                                      "out",  "threads", "each", "resume"};

std::string key_of(const CLI::Option& option) {
  if (!option.get_lnames().empty()) return option.get_lnames().front();
  std::string name = option.get_name(true);
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return name;
}

}  // namespace

void add_config_option(CLI::App& command, std::string& file) {
  command.add_option("--config", file, "Options from a TOML file; the command line wins");
}

Result<void> apply_option_file(const std::filesystem::path& file, CLI::App& command) {
  const Result<std::vector<FileOption>> given = read_option_file(file);
  if (!given) return given.failure();
  for (const auto& [name, values] : *given) {
    CLI::Option* target = nullptr;
    for (CLI::Option* option : command.get_options()) {
      if (key_of(*option) == name && name != "help" && name != "config") target = option;
    }
    if (target == nullptr) return error("{}: {} is not an option of {}", file.string(), name, command.get_name());
    if (target->count() > 0) continue;
    target->add_result(values);
    target->run_callback();
  }
  return {};
}

OptionLines option_lines(const CLI::App& command, const std::map<std::string, std::string>& chosen) {
  OptionLines lines;
  for (const CLI::Option* option : command.get_options()) {
    const std::string key = key_of(*option);
    if (std::ranges::count(kNotKept, key) > 0) continue;
    if (const auto choice = chosen.find(key); choice != chosen.end()) {
      lines.emplace_back(key, toml_value(choice->second));
    } else if (option->count() > 0 && option->get_items_expected_max() > 1) {
      lines.emplace_back(key, toml_list(option->results()));
    } else if (option->count() > 0) {
      lines.emplace_back(key, toml_value(option->results().back()));
    } else if (!option->get_default_str().empty()) {
      lines.emplace_back(key, toml_value(option->get_default_str()));
    }
  }
  return lines;
}

Result<Outcome> deliver(ResultDirectory& directory, const CLI::App& command,
                        const std::map<std::string, std::string>& chosen, Outcome outcome, Console& console) {
  if (outcome.interrupted) {
    const std::string line = fmt::format("interrupted; {} holds what is done", directory.path().string());
    outcome.json["error"] = line;
    console.error(line);
  }
  const Result<void> finished =
      finish_result(directory, command.get_name(), option_lines(command, chosen), outcome.json, outcome.interrupted);
  if (!finished) return finished.failure();
  return outcome;
}

}  // namespace silpose::app
