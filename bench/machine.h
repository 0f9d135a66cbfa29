// The measured peak performance of this machine: the bounds that curves are compared with. One thread.
// Threads: pure functions.
#pragma once

#include <cstddef>
#include <string>

namespace silpose::bench {

struct MachineBounds {
  double clock_hz = 0;             // from a chain of additions
  double multiply_adds_per_s = 0;  // single precision, the best instruction set
  double bytes_per_s = 0;          // read repeatedly from a working set of the requested size
};
MachineBounds measure_machine(size_t working_set_bytes);

// "AMD EPYC, 2 threads, AVX3_DL".
std::string machine_name();

}  // namespace silpose::bench
