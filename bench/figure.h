// Figure: one thing measured next to its peers, and how it is measured: all in turns in the same run, so that whatever
// else the machine does hits all alike.
// Threads: one at a time.
#pragma once

#include <functional>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace silpose::bench {

struct PeerFigure {
  std::string peer;       // what ran in the same run
  double peer_value = 0;  // median over the rounds
  double ratio = 0;       // above 1: ours is better
  // How much more of the processor the peer takes, all threads and started programs together: hardly disturbed by what
  // else the machine does.
  double processor_ratio = std::numeric_limits<double>::quiet_NaN();
};

struct Figure {
  double value = 0;  // median over the rounds
  std::string unit;
  double spread = 0;              // of our value: interquartile range over the median
  std::vector<PeerFigure> peers;  // the one to be measured by comes first
};

struct Contest {
  std::string unit;
  bool higher_is_better = true;  // a rate: amount per second; otherwise a duration: seconds per amount
  int rounds = 15;               // REQUIRES: at least 1
};

// One way to do the work.
struct Contestant {
  std::string name;
  double amount = 1;  // what one run does, in the unit's own count
  std::function<void()> run;
};

// Times all in turns, after one untimed run of each.
Figure measure(const Contest& contest, const Contestant& ours, std::span<const Contestant> peers);

// The q-quantile, interpolated. REQUIRES: values, 0 <= fraction <= 1.
double quantile(std::vector<double> values, double fraction);

// Keeps a result from being optimised away.
template <class T>
inline void keep(const T& value) {
  asm volatile("" : : "g"(&value) : "memory");
}

// Throws std::runtime_error: a wrong result is not timed.
void verify(bool condition, const std::string& what);

}  // namespace silpose::bench
