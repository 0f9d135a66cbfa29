// Counting the set bits of words, and of pairs of words that are combined: vector code built for every instruction set,
// of which the processor's best is taken at run time. For use by masks.
// Based on: Highway's dynamic dispatch (github.com/google/highway, g3doc/quick_reference.md).
// Threads: pure functions.
#pragma once

#include <cstdint>
#include <span>

namespace silpose {

[[nodiscard]] int64_t count_set_bits(std::span<const uint64_t> words);

// Bits of a ^ b, a & b and a | b. REQUIRES: equal sizes.
[[nodiscard]] int64_t count_xor_bits(std::span<const uint64_t> a, std::span<const uint64_t> b);
[[nodiscard]] int64_t count_and_bits(std::span<const uint64_t> a, std::span<const uint64_t> b);
[[nodiscard]] int64_t count_or_bits(std::span<const uint64_t> a, std::span<const uint64_t> b);

}  // namespace silpose
