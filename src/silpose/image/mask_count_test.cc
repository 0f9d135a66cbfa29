#include "silpose/image/mask_count.h"

#include <gtest/gtest.h>

#include <vector>

#include "silpose/base/rng.h"
#include "silpose/base/simd_targets.h"

namespace silpose {
namespace {

int64_t bits_of(uint64_t word) {
  int64_t count = 0;
  for (int bit = 0; bit < 64; ++bit) count += static_cast<int64_t>((word >> bit) & 1);
  return count;
}

void expect_counts(std::span<const uint64_t> a, std::span<const uint64_t> b) {
  int64_t in_a = 0, differ = 0, both = 0, either = 0;
  for (size_t i = 0; i < a.size(); ++i) {
    in_a += bits_of(a[i]);
    differ += bits_of(a[i] ^ b[i]);
    both += bits_of(a[i] & b[i]);
    either += bits_of(a[i] | b[i]);
  }
  EXPECT_EQ(count_set_bits(a), in_a);
  EXPECT_EQ(count_xor_bits(a, b), differ);
  EXPECT_EQ(count_and_bits(a, b), both);
  EXPECT_EQ(count_or_bits(a, b), either);
}

TEST(MaskCount, EveryTargetAgreesWithAPlainLoop) {
  Rng rng(1);
  std::vector<uint64_t> a(600), b(600);
  for (uint64_t& word : a) word = rng.bits();
  for (uint64_t& word : b) word = rng.bits() & rng.bits();
  for_each_simd_target([&](const char* name) {
    SCOPED_TRACE(name);
    for (const size_t count : {0, 1, 2, 3, 4, 7, 8, 9, 15, 31, 63, 64, 247, 248, 249, 256, 577}) {
      for (const size_t offset : {0, 1, 5}) {  // vectors that are not aligned
        SCOPED_TRACE(count);
        expect_counts(std::span(a).subspan(offset, count), std::span(b).subspan(offset, count));
      }
    }
  });
}

// More full words than a byte can count at a time.
TEST(MaskCount, FullWordsDoNotOverflow) {
  const std::vector<uint64_t> full(1000, ~uint64_t{0}), empty(1000, 0);
  for_each_simd_target([&](const char* name) {
    SCOPED_TRACE(name);
    expect_counts(full, empty);
    expect_counts(full, full);
  });
}

}  // namespace
}  // namespace silpose
