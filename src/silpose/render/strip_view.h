// StripView: a kernel's view of a StripOrder: nothing but pointers, so that no code of a library is compiled for one
// instruction set only. Threads: a value; the order must outlive it.
#pragma once

#include <cstddef>

#include "silpose/render/strip_order.h"

namespace silpose {

struct StripView {
  const StripOrder::Run* runs;
  size_t num_runs;
  const StripOrder::Pair* pairs;
  size_t num_pairs;
};

inline StripView view_of(const StripOrder& strips) {
  return {strips.runs.data(), strips.runs.size(), strips.pairs.data(), strips.pairs.size()};
}

}  // namespace silpose
