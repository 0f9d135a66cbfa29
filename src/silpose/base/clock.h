// Stopwatch: how long a stage took. Monotonic; time stamps of data are int64 nanoseconds and come with the data.
// Threads: a value.
#pragma once

#include <chrono>

namespace silpose {

class Stopwatch {
 public:
  // Seconds since construction or the last restart().
  [[nodiscard]] double seconds() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }
  double restart() {
    const double elapsed = seconds();
    start_ = Clock::now();
    return elapsed;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

}  // namespace silpose
