#include "silpose/base/rng.h"

#include <bit>
#include <cmath>

#include "silpose/base/check.h"

namespace silpose {
namespace {

uint64_t split_mix(uint64_t& state) {
  uint64_t z = (state += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

}  // namespace

Rng::Rng(uint64_t seed, uint64_t step, uint64_t particle) {
  // Each coordinate is mixed before the next one enters, so that (1, 0, 0) and (0, 1, 0) are unrelated.
  uint64_t mixed = seed;
  mixed = split_mix(mixed) ^ step;
  mixed = split_mix(mixed) ^ particle;
  for (uint64_t& word : state_) word = split_mix(mixed);
}

uint64_t Rng::bits() {
  const uint64_t result = std::rotl(state_[0] + state_[3], 23) + state_[0];
  const uint64_t shifted = state_[1] << 17;
  state_[2] ^= state_[0];
  state_[3] ^= state_[1];
  state_[1] ^= state_[2];
  state_[0] ^= state_[3];
  state_[2] ^= shifted;
  state_[3] = std::rotl(state_[3], 45);
  return result;
}

double Rng::normal() {
  if (has_spare_) {
    has_spare_ = false;
    return spare_;
  }
  double u = 0, v = 0, s = 0;
  do {
    u = uniform(-1, 1);
    v = uniform(-1, 1);
    s = u * u + v * v;
  } while (s >= 1 || s == 0);
  const double factor = std::sqrt(-2 * std::log(s) / s);
  spare_ = v * factor;
  has_spare_ = true;
  return u * factor;
}

uint64_t Rng::index(uint64_t count) {
  check(count > 0, "Rng::index: count is 0");
  // Rejection keeps every index equally likely.
  const uint64_t limit = ~uint64_t{0} - ~uint64_t{0} % count;
  uint64_t value = 0;
  do value = bits();
  while (value >= limit);
  return value % count;
}

}  // namespace silpose
