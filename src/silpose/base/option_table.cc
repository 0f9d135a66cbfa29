#include "silpose/base/option_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <locale>
#include <sstream>

namespace silpose {
namespace {

// What a value has to be, as errors say it.
std::string wanted(const OptionInfo& info) {
  switch (info.kind) {
    case OptionKind::kFlag:
      return "true or false";
    case OptionKind::kWhole:
      return fmt::format("a whole number from {:.0f} to {:.0f}", info.low, info.high);
    case OptionKind::kNumber:
      return fmt::format("a number from {:g} to {:g}", info.low, info.high);
    case OptionKind::kWord:
      return fmt::format("one of {}", fmt::join(info.words, ", "));
    case OptionKind::kText:
      return "a text";
    case OptionKind::kTexts:
      return "a list of texts";
    case OptionKind::kPair:
      return fmt::format("two numbers from {:g} to {:g}", info.low, info.high);
  }
  return "";
}

bool is_inside(const OptionInfo& info, double number) {
  return std::isfinite(number) && number >= info.low && number <= info.high;
}

std::optional<double> number_in(const std::string& text) {
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  double number = 0;
  if (!(stream >> number) || stream.peek() != std::char_traits<char>::eof()) return std::nullopt;
  return number;
}

std::vector<std::string> split(const std::string& text) {
  std::vector<std::string> parts;
  std::istringstream stream(text);
  for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
  return parts;
}

// The text as the type that the option needs; nothing where it cannot be that.
std::optional<OptionValue> typed(OptionKind kind, const std::string& text) {
  switch (kind) {
    case OptionKind::kFlag:
      if (text == "true" || text == "false") return text == "true";
      return std::nullopt;
    case OptionKind::kWhole: {
      int64_t whole = 0;
      const auto [end, bad] = std::from_chars(text.data(), text.data() + text.size(), whole);
      if (bad != std::errc() || end != text.data() + text.size()) return std::nullopt;
      return whole;
    }
    case OptionKind::kNumber:
      return number_in(text);
    case OptionKind::kWord:
    case OptionKind::kText:
      return text;
    case OptionKind::kTexts:
      return split(text);
    case OptionKind::kPair: {
      const std::vector<std::string> parts = split(text);
      if (parts.size() != 2) return std::nullopt;
      const auto first = number_in(parts[0]), second = number_in(parts[1]);
      if (!first || !second) return std::nullopt;
      return std::array{*first, *second};
    }
  }
  return std::nullopt;
}

// Whether a value of the right type is one of those that the option takes.
bool is_allowed(const OptionInfo& info, const OptionValue& value) {
  switch (info.kind) {
    case OptionKind::kWhole:
      return is_inside(info, static_cast<double>(std::get<int64_t>(value)));
    case OptionKind::kNumber:
      return is_inside(info, std::get<double>(value));
    case OptionKind::kWord:
      return std::ranges::count(info.words, std::get<std::string>(value)) > 0;
    case OptionKind::kPair:
      return std::ranges::all_of(std::get<std::array<double, 2>>(value), [&](double x) { return is_inside(info, x); });
    case OptionKind::kFlag:
    case OptionKind::kText:
    case OptionKind::kTexts:
      return true;
  }
  return false;
}

size_t type_of(OptionKind kind) {
  switch (kind) {
    case OptionKind::kFlag:
      return OptionValue(false).index();
    case OptionKind::kWhole:
      return OptionValue(int64_t{0}).index();
    case OptionKind::kNumber:
      return OptionValue(0.0).index();
    case OptionKind::kWord:
    case OptionKind::kText:
      return OptionValue(std::string()).index();
    case OptionKind::kTexts:
      return OptionValue(std::vector<std::string>()).index();
    case OptionKind::kPair:
      return OptionValue(std::array<double, 2>()).index();
  }
  return std::variant_npos;
}

// A value in an error: text in quotes, lists in brackets.
std::string quoted(const OptionValue& value) {
  if (std::holds_alternative<std::string>(value)) return fmt::format("'{}'", std::get<std::string>(value));
  if (std::holds_alternative<std::vector<std::string>>(value)) return fmt::format("[{}]", text_of(value));
  return text_of(value);
}

std::string replaced(std::string_view text, char from, char to) {
  std::string result(text);
  std::ranges::replace(result, from, to);
  return result;
}

}  // namespace

Result<OptionValue> read_option(const OptionInfo& info, const OptionValue& given) {
  OptionValue value = given;
  if (info.kind == OptionKind::kNumber && std::holds_alternative<int64_t>(given)) {
    value = static_cast<double>(std::get<int64_t>(given));
  }
  if (value.index() != type_of(info.kind) || !is_allowed(info, value)) {
    return error("{} is not {}", quoted(given), wanted(info));
  }
  return value;
}

Result<OptionValue> parse_option(const OptionInfo& info, const std::string& text) {
  const std::optional<OptionValue> value = typed(info.kind, text);
  if (!value) return error("'{}' is not {}", text, wanted(info));
  return read_option(info, *value);
}

std::string text_of(const OptionValue& value) {
  return std::visit(
      [](const auto& of_type) -> std::string {
        using T = std::decay_t<decltype(of_type)>;
        if constexpr (std::same_as<T, std::vector<std::string>> || std::same_as<T, std::array<double, 2>>) {
          return fmt::format("{}", fmt::join(of_type, ","));
        } else {
          return fmt::format("{}", of_type);
        }
      },
      value);
}

std::string values_text(const OptionInfo& info) {
  switch (info.kind) {
    case OptionKind::kWhole:
      return fmt::format("{:.0f} to {:.0f}", info.low, info.high);
    case OptionKind::kNumber:
      return fmt::format("{:g} to {:g}", info.low, info.high);
    case OptionKind::kWord:
      return fmt::format("{}", fmt::join(info.words, ", "));
    case OptionKind::kFlag:
    case OptionKind::kText:
    case OptionKind::kTexts:
    case OptionKind::kPair:
      return wanted(info);
  }
  return "";
}

std::string with_underscores(std::string_view name) { return replaced(name, '-', '_'); }
std::string with_dashes(std::string_view key) { return replaced(key, '_', '-'); }

Words<std::string> words_from(std::span<const std::string_view> names) {
  Words<std::string> words;
  for (const std::string_view name : names) words.emplace_back(name, name);
  return words;
}

}  // namespace silpose
