// OptionError: options of a user that do not go together, or a value that is known to be wrong only where all options
// are put together. Programs report it as wrong usage.
// Threads: a value and a function without state.
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

namespace silpose {

// The message names the option as on the command line: "--start 2: is after --end 1".
struct OptionError : std::invalid_argument {
  using std::invalid_argument::invalid_argument;
};

template <class... Args>
[[noreturn]] void throw_option_error(fmt::format_string<Args...> format, Args&&... args) {
  throw OptionError(fmt::format(format, std::forward<Args>(args)...));
}

}  // namespace silpose
