// The median of a few numbers; of an even count the upper one. Threads: a pure function.
#pragma once

#include <algorithm>
#include <iterator>
#include <vector>

#include "silpose/base/check.h"

namespace silpose {

// Errors: throws std::invalid_argument for no values.
template <class T>
[[nodiscard]] T upper_median(std::vector<T> values) {
  check(!values.empty(), "upper_median: of nothing");
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace silpose
