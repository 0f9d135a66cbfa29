#include "apps/silpose/option_file.h"

#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <fstream>
#include <optional>
#include <sstream>

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

std::optional<std::string> as_typed(const toml::node& node) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* flag = node.as_boolean()) return flag->get() ? "true" : "false";
  if (node.is_number()) {
    std::ostringstream stream;
    stream.imbue(std::locale::classic());
    stream.precision(17);
    if (const auto* whole = node.as_integer()) {
      stream << whole->get();
    } else {
      stream << node.as_floating_point()->get();
    }
    return stream.str();
  }
  return std::nullopt;
}

// As TOML: a bare number or boolean where it reads as one, otherwise a quoted string.
std::string as_toml(const std::string& typed) {
  if (typed == "true" || typed == "false") return typed;
  double number = 0;
  const auto [end, bad] = std::from_chars(typed.data(), typed.data() + typed.size(), number);
  const bool plain = typed.find_first_not_of("0123456789.-") == std::string::npos && typed.front() != '.' &&
                     typed.back() != '.' && (typed.size() < 2 || typed[0] != '0' || typed[1] == '.');
  if (bad == std::errc() && end == typed.data() + typed.size() && plain) return typed;
  std::ostringstream quoted;
  quoted << toml::value<std::string>(typed);
  return quoted.str();
}

}  // namespace

Result<void> apply_option_file(const std::filesystem::path& file, CLI::App& command) {
  std::ifstream stream(file);
  if (!stream) return error("{}: no such file", file.string());
  toml::table table;
  try {
    table = toml::parse(stream, file.string());
  } catch (const toml::parse_error& broken) {
    return error("{}: line {}: {}", file.string(), broken.source().begin.line, broken.description());
  }
  for (const auto& [toml_key, node] : table) {
    const std::string key(toml_key.str());
    CLI::Option* target = nullptr;
    for (CLI::Option* option : command.get_options()) {
      if (key_of(*option) == key && key != "help" && key != "config") target = option;
    }
    if (target == nullptr) return error("{}: {} is not an option of {}", file.string(), key, command.get_name());
    if (target->count() > 0) continue;
    std::vector<std::string> values;
    if (const toml::array* array = node.as_array()) {
      for (const toml::node& element : *array) {
        const std::optional<std::string> value = as_typed(element);
        if (!value) return error("{}: {}: not a list of plain values", file.string(), key);
        values.push_back(*value);
      }
    } else {
      const std::optional<std::string> value = as_typed(node);
      if (!value) return error("{}: {}: not a plain value", file.string(), key);
      values.push_back(*value);
    }
    target->add_result(values);
    target->run_callback();
  }
  return {};
}

OptionLines option_lines(const CLI::App& command, const std::map<std::string, std::string>& chosen) {
  OptionLines lines;
  for (const CLI::Option* option : command.get_options()) {
    const std::string key = key_of(*option);
    if (std::find(kNotKept.begin(), kNotKept.end(), key) != kNotKept.end()) continue;
    const auto choice = chosen.find(key);
    if (choice != chosen.end()) {
      lines.emplace_back(key, as_toml(choice->second));
    } else if (option->count() > 0 && option->get_items_expected_max() > 1) {
      std::string list;
      for (const std::string& value : option->results()) list += (list.empty() ? "" : ", ") + as_toml(value);
      lines.emplace_back(key, "[" + list + "]");
    } else if (option->count() > 0) {
      lines.emplace_back(key, as_toml(option->results().back()));
    } else if (!option->get_default_str().empty()) {
      lines.emplace_back(key, as_toml(option->get_default_str()));
    }
  }
  return lines;
}

Result<void> write_option_file(const std::filesystem::path& file, const CLI::App& command,
                               const std::map<std::string, std::string>& chosen) {
  std::ofstream stream(file);
  stream << "# Options of silpose " << command.get_name() << "; give this file to --config.\n";
  for (const auto& [key, value] : option_lines(command, chosen)) stream << key << " = " << value << "\n";
  stream.flush();
  if (!stream) return error("{}: not writable", file.string());
  return {};
}

}  // namespace silpose::app
