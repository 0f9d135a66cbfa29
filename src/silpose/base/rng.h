// Rng: random numbers by stream. Every (seed, step, particle) has a stream of its own, so that a result does not
// depend on how the work was spread over threads.
// Based on: xoshiro256++ seeded by SplitMix64 (references.bib: blackman2021). Not for cryptography.
// Threads: one Rng per thread; streams are independent.
#pragma once

#include <cstdint>

namespace silpose {

class Rng {
 public:
  // The stream of (seed, step, particle); the last two default to the stream of a whole run.
  explicit Rng(uint64_t seed, uint64_t step = 0, uint64_t particle = 0);

  // Uniform 64 bits.
  uint64_t bits();

  // Uniform in [0, 1), 53 bits.
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1.0p-53; }

  // Uniform in [lower, upper).
  double uniform(double lower, double upper) { return lower + (upper - lower) * uniform(); }

  // Standard normal (polar method).
  double normal();

  // Uniform in {0, ..., count - 1}. REQUIRES: count > 0.
  uint64_t index(uint64_t count);

 private:
  uint64_t state_[4];
  double spare_ = 0;
  bool has_spare_ = false;
};

}  // namespace silpose
