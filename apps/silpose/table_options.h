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

// Adds the option. What is given is checked, and `take` is called with it.
CLI::Option* add_table_option(CLI::App& app, const OptionInfo& info, const std::string& help,
                              const std::function<void(const OptionValue&)>& take);

// Adds all options of the table. What is given is set in `options`, which must outlive the parsing; what is there
// before are the defaults, which help tells.
template <class S>
void add_table_options(CLI::App& app, const OptionTable<S>& table, S& options) {
  for (const Option<S>& option : table.options) {
    CLI::Option* const added = add_table_option(app, option.info, option.info.help,
                                                [&](const OptionValue& given) { option.set(options, given); });
    if (const auto value = option.get(options)) added->default_str(text_of(*value));
  }
}

// The same for options whose defaults depend on others: what is given is kept in `given`, by name. `group`: of the
// help. `defaults_of`: how the help tells what holds otherwise, from an option's name. `beside`: what else to add right
// after an option, so that related ones are together.
template <class S>
void add_table_options(CLI::App& app, const OptionTable<S>& table, const std::string& group,
                       const std::function<std::string(std::string_view)>& defaults_of,
                       const std::map<std::string_view, std::function<void()>>& beside, GivenOptions& given) {
  for (const Option<S>& option : table.options) {
    const OptionInfo& info = option.info;
    const std::string defaults = defaults_of(info.name);
    const std::string help = defaults.empty() ? info.help : fmt::format("{} ({})", info.help, defaults);
    CLI::Option* const added =
        add_table_option(app, info, help, [&](const OptionValue& value) { given.insert_or_assign(info.name, value); });
    added->group(group);
    // Every tracker takes this value: it is written with a result even where nothing has the option.
    if (info.off && info.kind != OptionKind::kFlag) added->default_str(text_of(*info.off));
    if (const auto more = beside.find(info.name); more != beside.end()) more->second();
  }
}

}  // namespace silpose::app
