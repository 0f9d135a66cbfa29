// Console: what the user sees while a command works: messages and progress on stderr, and Ctrl-C.
// Threads: the main thread; the interrupt flag is set by a signal handler.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <string_view>

#include "silpose/base/progress.h"

namespace silpose::app {

class Console : public ProgressSink {
 public:
  Console();
  ~Console() override;
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  void set_quiet(bool quiet) { quiet_ = quiet; }

  // From here on Ctrl-C and SIGTERM ask the work to stop cleanly; a second one ends the program at once.
  static void watch_interrupts();
  static bool interrupted();

  // Progress with the time left: on a terminal a line that rewrites itself, otherwise a line every few seconds.
  bool update(std::string_view what, int64_t done, int64_t total) override;

  void message(std::string_view line);  // not when quiet
  void warning(std::string_view line);  // always
  void error(std::string_view line);    // always

 private:
  void clear_line();
  using Clock = std::chrono::steady_clock;
  bool quiet_ = false, terminal_;
  bool line_open_ = false;
  std::string what_;
  int64_t first_done_ = 0;
  Clock::time_point start_, last_;
};

}  // namespace silpose::app
