#include "silpose/base/option_file.h"

#include <toml++/toml.h>

#include <charconv>
#include <locale>
#include <optional>
#include <sstream>

#include "silpose/base/text_file.h"

namespace silpose {
namespace {

std::optional<std::string> text_of_value(const toml::node& node) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* flag = node.as_boolean()) return flag->get() ? "true" : "false";
  if (!node.is_number()) return std::nullopt;
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

// Whether TOML reads the text as the number that it is: neither "012" nor "5." nor "1e3".
bool is_plain_number(const std::string& text) {
  if (text.empty() || text.find_first_not_of("0123456789.-") != std::string::npos) return false;
  if (text.front() == '.' || text.back() == '.') return false;
  if (text.size() > 1 && text[0] == '0' && text[1] != '.') return false;
  double number = 0;
  const auto [end, bad] = std::from_chars(text.data(), text.data() + text.size(), number);
  return bad == std::errc() && end == text.data() + text.size();
}

}  // namespace

Result<std::vector<FileOption>> read_option_file(const std::filesystem::path& file) {
  const Result<std::string> text = read_text_file(file);
  if (!text) return text.failure();
  toml::table table;
  try {
    table = toml::parse(std::string_view(*text), file.string());
  } catch (const toml::parse_error& broken) {
    return error("{}: line {}: {}", file.string(), broken.source().begin.line, broken.description());
  }
  std::vector<FileOption> options;
  for (const auto& [key, node] : table) {
    FileOption& option = options.emplace_back(FileOption{std::string(key.str()), {}});
    const toml::array* const list = node.as_array();
    for (size_t i = 0; i < (list != nullptr ? list->size() : 1); ++i) {
      const std::optional<std::string> value = text_of_value(list != nullptr ? (*list)[i] : node);
      if (!value) {
        return error("{}: {}: not a {}", file.string(), option.name,
                     list != nullptr ? "list of plain values" : "plain value");
      }
      option.values.push_back(*value);
    }
  }
  return options;
}

std::string toml_value(const std::string& text) {
  if (text == "true" || text == "false" || is_plain_number(text)) return text;
  std::ostringstream quoted;
  quoted << toml::value<std::string>(text);
  return quoted.str();
}

std::string toml_list(const std::vector<std::string>& texts) {
  std::string list;
  for (const std::string& text : texts) list += (list.empty() ? "" : ", ") + toml_value(text);
  return "[" + list + "]";
}

Result<void> write_option_file(const std::filesystem::path& file, std::string_view command, const OptionLines& lines) {
  std::string text = fmt::format("# Options of silpose {}; give this file to --config.\n", command);
  for (const auto& [key, value] : lines) text += fmt::format("{} = {}\n", key, value);
  return write_text_file(file, text);
}

}  // namespace silpose
