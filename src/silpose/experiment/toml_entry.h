// TomlEntry: one value of a description, read as what it should be; errors name file and key. Private to the module
// `experiment`.
// Threads: functions without state.
#pragma once

#include <toml++/toml.h>

#include <array>
#include <functional>
#include <initializer_list>
#include <map>
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

// Settings that were given, and where: "motion" maps to "grid.toml: run.motion".
using GivenSettings = std::map<std::string, std::string, std::less<>>;

// Changes the settings that a table names, and notes them in `given`. `where` begins the name of each in errors.
// Errors: a key that is no setting; a value that it cannot have.
Result<void> apply_settings(const toml::table& table, const std::string& where, RunSettings& run,
                            GivenSettings* given = nullptr);

// Whether a cell's settings belong together: those of recorded clips, or those of rendered sequences.
// Errors: a key that needs a clip, or that does not go with one; a clip without camera or truth, with another number of
// names than videos, or with evidence that its segmenter does not give.
Result<void> check_settings(const GivenSettings& given, const RunSettings& run);

}  // namespace silpose
