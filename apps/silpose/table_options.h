// Options of an OptionTable on the command line (CLI11), and in option files through it.
// Threads: the main thread only.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "silpose/base/option_table.h"

namespace silpose::app {

// Adds the option; what is given is checked and kept in `given`, which must outlive the parsing. `defaults`: how the
// help tells what holds otherwise; empty: nothing.
void add_table_option(CLI::App& app, const OptionInfo& info, const std::string& group, const std::string& defaults,
                      GivenOptions& given);

// Adds all options of the table. `beside`: what else to add right after an option, so that related ones are together.
// `defaults_of` makes the defaults of each from its name.
template <class S>
void add_table_options(CLI::App& app, const OptionTable<S>& table, const std::string& group,
                       const std::function<std::string(std::string_view)>& defaults_of,
                       const std::map<std::string_view, std::function<void()>>& beside, GivenOptions& given) {
  for (const Option<S>& option : table.options) {
    add_table_option(app, option.info, group, defaults_of(option.info.name), given);
    if (const auto more = beside.find(option.info.name); more != beside.end()) more->second();
  }
}

}  // namespace silpose::app
