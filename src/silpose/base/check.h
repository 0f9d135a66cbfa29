// check(): preconditions. A false one is the caller's bug and throws std::invalid_argument with the values.
// Threads: a function without state.
#pragma once

#include <fmt/format.h>

#include <stdexcept>
#include <utility>

namespace silpose {

template <class... Args>
void check(bool condition, fmt::format_string<Args...> format, Args&&... args) {
  if (!condition) [[unlikely]] {
    throw std::invalid_argument(fmt::format(format, std::forward<Args>(args)...));
  }
}

}  // namespace silpose
