// RunContext: what a program gives to what it runs: where data lie, who hears of progress and of what is being done.
// ProgramRun: what results say of the program.
// Threads: values; calls of a context come from the thread that runs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>

#include "silpose/base/progress.h"

namespace silpose {

struct RunContext {
  std::filesystem::path data;                            // data_directory() (base/data_folder.h)
  ProgressSink* progress = nullptr;                      // may be null; must outlive the run
  std::function<void(const std::string& line)> message;  // may be empty: one line for the user, no warning

  void tell(const std::string& line) const {
    if (message) message(line);
  }
  // False asks to stop, as ProgressSink::update().
  [[nodiscard]] bool update(std::string_view what, int64_t done, int64_t total) const {
    return progress == nullptr || progress->update(what, done, total);
  }
};

struct ProgramRun {
  std::string version;
  std::string command_line;  // as typed
  uint64_t seed = 1;
};

}  // namespace silpose
