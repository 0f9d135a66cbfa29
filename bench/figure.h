// Figure: one thing measured next to a peer, and how it is measured: both in turns in the same run, so that whatever
// else the machine does hits both alike.
// Threads: one at a time.
#pragma once

#include <functional>
#include <string>

namespace silpose::bench {

struct Figure {
  double value = 0;  // median over the rounds
  std::string unit;
  std::string peer;       // what ran in the same run
  double peer_value = 0;  // median over the rounds
  double ratio = 0;       // above 1: ours is better
  double spread = 0;      // of our value: interquartile range over the median
};

struct Contest {
  std::string unit, peer;
  bool higher_is_better = true;
  double value_at_one_second = 1;  // what a run of one second stands for: runs are turned into values by it
  int rounds = 15;
};

// Times `ours` and `theirs` in turns, after one untimed run of each. A rate is value_at_one_second / seconds, a
// duration value_at_one_second x seconds.
Figure measure(const Contest& contest, const std::function<void()>& ours, const std::function<void()>& theirs);

// Keeps a result from being optimised away.
template <class T>
inline void keep(const T& value) {
  asm volatile("" : : "g"(&value) : "memory");
}

// Throws std::runtime_error: a wrong result is not timed.
void verify(bool condition, const std::string& what);

}  // namespace silpose::bench
