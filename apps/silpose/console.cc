#include "apps/silpose/console.h"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdio>

namespace silpose::app {
namespace {

std::atomic<bool> interrupt_asked{false};
static_assert(std::atomic<bool>::is_always_lock_free);

extern "C" void on_interrupt(int signal_number) {
  interrupt_asked.store(true, std::memory_order_relaxed);
  std::signal(signal_number, SIG_DFL);
}

std::string duration_text(double seconds) {
  const auto whole = std::llround(seconds);
  if (whole >= 3600) return fmt::format("{} h {:02} min", whole / 3600, whole / 60 % 60);
  if (whole >= 60) return fmt::format("{} min {:02} s", whole / 60, whole % 60);
  return fmt::format("{} s", whole);
}

double seconds_between(std::chrono::steady_clock::time_point from, std::chrono::steady_clock::time_point to) {
  return std::chrono::duration<double>(to - from).count();
}

}  // namespace

Console::Console() : terminal_(isatty(STDERR_FILENO) != 0) {}
Console::~Console() { clear_line(); }

void Console::watch_interrupts() {
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
  std::signal(SIGXFSZ, SIG_IGN);  // exceeding the file size limit is a write error, as a full disk is
}
bool Console::interrupted() { return interrupt_asked.load(std::memory_order_relaxed); }

bool Console::update(std::string_view what, int64_t done, int64_t total) {
  if (quiet_) return !interrupted();
  const Clock::time_point now = Clock::now();
  if (what != what_) {
    clear_line();
    what_ = what;
    first_done_ = done;
    start_ = last_ = now;
    return !interrupted();
  }
  if (seconds_between(last_, now) < (terminal_ ? 0.2 : 5.0)) return !interrupted();
  last_ = now;
  std::string line = total > 0 ? fmt::format("{}: {} of {}", what, done, total) : fmt::format("{}: {}", what, done);
  const double elapsed = seconds_between(start_, now);
  if (done > first_done_ && elapsed > 1) {
    const double rate = static_cast<double>(done - first_done_) / elapsed;
    line += fmt::format(", {:.1f} per second", rate);
    if (total > done) line += fmt::format(", {} left", duration_text(static_cast<double>(total - done) / rate));
  }
  if (terminal_) {
    fmt::print(stderr, "\r\033[K{}", line);
    line_open_ = true;
  } else {
    fmt::print(stderr, "{}\n", line);
  }
  std::fflush(stderr);
  return !interrupted();
}

void Console::clear_line() {
  if (line_open_) fmt::print(stderr, "\r\033[K");
  line_open_ = false;
}

void Console::message(std::string_view line) {
  clear_line();
  if (!quiet_) fmt::print(stderr, "{}\n", line);
}
void Console::warning(std::string_view line) {
  clear_line();
  fmt::print(stderr, "silpose: warning: {}\n", line);
}
void Console::error(std::string_view line) {
  clear_line();
  fmt::print(stderr, "silpose: {}\n", line);
}

}  // namespace silpose::app
