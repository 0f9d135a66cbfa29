// TomlEntry: one value of a description, read as what it should be; errors name file and key. Private to the module
// `experiment`.
// Threads: functions without state.
#pragma once

#include <toml++/toml.h>

#include <map>
#include <string>
#include <vector>

#include "silpose/base/option_table.h"
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
Result<int> integer_of(const TomlEntry& entry, int low, int high);  // both included
Result<std::vector<std::string>> texts_of(const TomlEntry& entry);

// Whatever it is. Errors: a table, a date, or a list of anything but texts or of two numbers.
Result<OptionValue> value_of(const TomlEntry& entry);

// Takes a value over when it was read: `return take(text_of(entry), name);`
template <class T, class U>
Result<void> take(const Result<T>& read, U& into) {
  if (!read) return read.failure();
  into = *read;
  return {};
}

// Settings that were given, and where: "motion" maps to "grid.toml: run.motion". Options of the tracker have their
// prefix: "tracker_sigma_deg".
using GivenSettings = std::map<std::string, std::string, std::less<>>;

// Changes the settings that a table names, and notes them in `given`. `where` begins the name of each in errors.
// Errors: a key that is no setting; a value that it cannot have.
Result<void> apply_settings(const toml::table& table, const std::string& where, RunSettings& run,
                            GivenSettings* given = nullptr);

// Whether a cell's settings belong together: those of recorded clips, or those of rendered sequences; those of its kind
// of run; options of the tracker that its filter has.
// Errors: a key that needs a clip, or that does not go with one; a clip without camera or truth, with another number of
// names than videos, or with evidence that its segmenter does not give; a key that the kind or the filter does not
// have.
Result<void> check_settings(const GivenSettings& given, const RunSettings& run);

}  // namespace silpose
