// OptionTable: the options of a struct, each written down once: its name, its member, the values that it takes and what
// it does. Command lines, option files, config.toml, the cells of experiments and docs/options.md are made from tables.
// Adding an option is one line:
//
//   {"sigma-deg", &SamplingOptions::sigma_deg, between(1e-3, 90), "Noise of a typical joint angle in 1/30 s"},
//
// A member is a bool, an int or a double with a range, an enum with its words, a text, one of several texts, a list of
// texts, a pair of numbers, or a std::optional of one of these, which is unset until a value is given.
// Threads: values and functions without state.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "silpose/base/check.h"
#include "silpose/base/result.h"

namespace silpose {

// A value as a command line or a file gives it.
using OptionValue = std::variant<bool, int64_t, double, std::string, std::vector<std::string>, std::array<double, 2>>;

// Options that are given, by name.
using GivenOptions = std::map<std::string, OptionValue, std::less<>>;

enum class OptionKind { kFlag, kWhole, kNumber, kWord, kText, kTexts, kPair };

// All that is known of an option apart from its struct.
struct OptionInfo {
  std::string name;  // as on the command line, without dashes in front
  OptionKind kind = OptionKind::kText;
  double low = 0, high = 0;        // of numbers, both included
  std::vector<std::string> words;  // of kWord
  std::string help;
  // The value that asks for nothing: false. It may be given where nothing has the option.
  std::optional<OptionValue> off;
};

// The value as its option needs it: a whole number also stands for a number.
// Errors: "0 is not a whole number from 2 to 1000000"; without the option's name, which the caller puts in front.
Result<OptionValue> read_option(const OptionInfo& info, const OptionValue& given);

// The same from text, as on a command line. Lists and pairs are separated by commas.
Result<OptionValue> parse_option(const OptionInfo& info, const std::string& text);

// A value as parse_option() reads it.
std::string text_of(const OptionValue& value);

// The values that an option takes: "2 to 1000000", "mean, mode, cluster".
std::string values_text(const OptionInfo& info);

// "sigma-deg" as a key of an experiment, "sigma_deg", and back.
std::string with_underscores(std::string_view name);
std::string with_dashes(std::string_view key);

struct NumberRange {
  double low, high;
};
constexpr NumberRange between(double low, double high) { return {low, high}; }

// The words of an option and what each means. A bool's: first that of false.
template <class T>
using Words = std::vector<std::pair<std::string, T>>;

// Words that stand for themselves.
Words<std::string> words_from(std::span<const std::string_view> names);

namespace option_detail {

template <class T>
struct Inner {
  using type = T;
};
template <class T>
struct Inner<std::optional<T>> {
  using type = T;
};
template <class T>
using InnerOf = typename Inner<T>::type;

template <class T>
concept IsNumber = std::same_as < InnerOf<T>,
int > || std::same_as<InnerOf<T>, double>;

template <class T>
std::optional<OptionValue> value_from(const T& member) {
  if constexpr (!std::same_as<T, InnerOf<T>>) {
    if (!member) return std::nullopt;
    return value_from(*member);
  } else if constexpr (std::same_as<T, int>) {
    return OptionValue(int64_t{member});
  } else {
    return OptionValue(member);
  }
}

template <class T>
void store(const OptionValue& value, T& member) {
  if constexpr (std::same_as<InnerOf<T>, int>) {
    member = static_cast<int>(std::get<int64_t>(value));
  } else {
    member = std::get<InnerOf<T>>(value);
  }
}

}  // namespace option_detail

template <class S>
struct Option {
  OptionInfo info;
  std::function<void(S&, const OptionValue&)> set;          // REQUIRES: a value from read_option() or parse_option()
  std::function<std::optional<OptionValue>(const S&)> get;  // nothing: unset

  Option(OptionInfo about, std::function<void(S&, const OptionValue&)> setter,
         std::function<std::optional<OptionValue>(const S&)> getter)
      : info(std::move(about)), set(std::move(setter)), get(std::move(getter)) {}

  template <option_detail::IsNumber T>
  Option(std::string_view name, T S::*member, NumberRange range, std::string_view help)
      : Option(member, {.name = std::string(name),
                        .kind = std::same_as<option_detail::InnerOf<T>, int> ? OptionKind::kWhole : OptionKind::kNumber,
                        .low = range.low,
                        .high = range.high,
                        .help = std::string(help)}) {}

  Option(std::string_view name, bool S::*member, std::string_view help)
      : Option(member,
               {.name = std::string(name), .kind = OptionKind::kFlag, .help = std::string(help), .off = false}) {}

  Option(std::string_view name, std::string S::*member, std::string_view help)
      : Option(member, {.name = std::string(name), .kind = OptionKind::kText, .help = std::string(help)}) {}

  Option(std::string_view name, std::vector<std::string> S::*member, std::string_view help)
      : Option(member, {.name = std::string(name), .kind = OptionKind::kTexts, .help = std::string(help)}) {}

  Option(std::string_view name, std::optional<std::array<double, 2>> S::*member, NumberRange range,
         std::string_view help)
      : Option(member, {.name = std::string(name),
                        .kind = OptionKind::kPair,
                        .low = range.low,
                        .high = range.high,
                        .help = std::string(help)}) {}

  template <class T>
  Option(std::string_view name, T S::*member, const Words<option_detail::InnerOf<T>>& words, std::string_view help)
      : info{.name = std::string(name), .kind = OptionKind::kWord, .help = std::string(help)} {
    for (const auto& [word, value] : words) info.words.push_back(word);
    if constexpr (std::same_as<T, bool>) info.off = info.words.front();
    set = [member, words](S& options, const OptionValue& given) {
      for (const auto& [word, value] : words) {
        if (word == std::get<std::string>(given)) options.*member = value;
      }
    };
    get = [member, words](const S& options) -> std::optional<OptionValue> {
      for (const auto& [word, value] : words) {
        if (options.*member == value) return OptionValue(word);
      }
      if constexpr (std::same_as<T, std::string>) return OptionValue(options.*member);  // none of the words: not valid
      return std::nullopt;
    };
  }

 private:
  template <class T>
  Option(T S::*member, OptionInfo about)
      : info(std::move(about)),
        set([member](S& options, const OptionValue& value) { option_detail::store(value, options.*member); }),
        get([member](const S& options) { return option_detail::value_from(options.*member); }) {}
};

template <class S>
struct OptionTable {
  std::string group;  // what they are options of: a heading
  std::vector<Option<S>> options;

  // Null where there is no option of that name.
  [[nodiscard]] const Option<S>* find(std::string_view name) const {
    for (const Option<S>& option : options) {
      if (option.info.name == name) return &option;
    }
    return nullptr;
  }

  // Sets the options that are given and leaves the others as they are.
  void apply(const GivenOptions& given, S& to) const {
    for (const Option<S>& option : options) {
      if (const auto value = given.find(option.info.name); value != given.end()) option.set(to, value->second);
    }
  }

  // Adds every option that has a value.
  void collect(const S& from, GivenOptions& values) const {
    for (const Option<S>& option : options) {
      if (auto value = option.get(from)) values.insert_or_assign(option.info.name, std::move(*value));
    }
  }

  // Errors: throws std::invalid_argument that names the option and its value: "layers: 0 is not a whole number ...".
  void check(const S& values) const {
    for (const Option<S>& option : options) {
      const std::optional<OptionValue> value = option.get(values);
      if (!value) continue;
      const Result<OptionValue> read = read_option(option.info, *value);
      silpose::check(read.ok(), "{}: {}", option.info.name, read.ok() ? "" : read.error().message);
    }
  }
};

}  // namespace silpose
