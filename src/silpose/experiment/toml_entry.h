// TomlEntry: one value of a description, read as what it should be; errors name file and key. Private to the module
// `experiment`.
// Threads: functions without state.
#pragma once

#include <toml++/toml.h>

#include <array>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

#include "silpose/base/result.h"
#include "silpose/experiment/run_settings.h"

namespace silpose {

// A value of the file and the words that name it in errors: "grid.toml: run.frames".
struct TomlEntry {
  const toml::node& node;
  std::string where;
};

Result<std::string> text_of(const TomlEntry& entry);
Result<bool> flag_of(const TomlEntry& entry);
Result<double> number_of(const TomlEntry& entry, double low, double high);  // both included
Result<int> integer_of(const TomlEntry& entry, int low, int high);
Result<std::vector<std::string>> texts_of(const TomlEntry& entry);
Result<std::array<double, 2>> pair_of(const TomlEntry& entry, double low, double high);
Result<std::string> word_of(const TomlEntry& entry, std::initializer_list<std::string_view> words);

// Takes a value over when it was read: `return take(text_of(entry), name);`
template <class T, class U>
Result<void> take(const Result<T>& read, U& into) {
  if (!read) return read.failure();
  into = *read;
  return {};
}

// Changes the settings that a table names. `where` begins the name of each in errors.
// Errors: a key that is no setting; a value that it cannot have.
Result<void> apply_settings(const toml::table& table, const std::string& where, RunSettings& run);

}  // namespace silpose
