// ExperimentDirectory: experiments under DIR, one folder each. They are made in DIR.partial, where finished runs are
// kept for --resume, and moved to DIR/NAME when all are complete; other experiments in DIR stay. A DIR that holds
// anything else is refused.
// Threads: one thread per directory.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "silpose/base/result.h"

namespace silpose {

class ExperimentDirectory {
 public:
  // Makes DIR.partial. What is there from a run that was stopped is kept with `resume`, and removed without.
  // Errors: DIR or DIR.partial is a file or holds something that is no experiment; not writable.
  static Result<ExperimentDirectory> create(const std::filesystem::path& directory, bool resume);

  // Where to write the experiment `name`.
  [[nodiscard]] std::filesystem::path path(const std::string& name) const { return partial_ / name; }

  // Moves the experiments `names` to DIR, without their runs/, and removes DIR.partial.
  Result<void> commit(const std::vector<std::string>& names);

 private:
  std::filesystem::path final_, partial_;
};

}  // namespace silpose
