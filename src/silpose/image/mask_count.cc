#include "silpose/image/mask_count.h"

#include <algorithm>
#include <bit>
#include <cstddef>

#define HWY_WANT_AVX3_DL 1  // has an instruction that counts bits
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "silpose/image/mask_count.cc"
#include <hwy/foreach_target.h>  // IWYU pragma: keep
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace silpose::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

struct First {
  template <class T>
  HWY_INLINE T operator()(T a, T) const {
    return a;
  }
};
struct Xor {
  template <class T>
  HWY_INLINE T operator()(T a, T b) const {
    return hn::Xor(a, b);
  }
  HWY_INLINE uint64_t operator()(uint64_t a, uint64_t b) const { return a ^ b; }
};
struct And {
  template <class T>
  HWY_INLINE T operator()(T a, T b) const {
    return hn::And(a, b);
  }
  HWY_INLINE uint64_t operator()(uint64_t a, uint64_t b) const { return a & b; }
};
struct Or {
  template <class T>
  HWY_INLINE T operator()(T a, T b) const {
    return hn::Or(a, b);
  }
  HWY_INLINE uint64_t operator()(uint64_t a, uint64_t b) const { return a | b; }
};

template <class Combine>
HWY_INLINE int64_t count(const uint64_t* a, const uint64_t* b, size_t num_words, Combine combine) {
  int64_t total = 0;
  size_t i = 0;
#if HWY_TARGET != HWY_SCALAR
  const hn::ScalableTag<uint64_t> words;
  const hn::Repartition<uint8_t, decltype(words)> bytes;
  constexpr size_t kMostPerByte = 255 / 8;  // vectors whose bits a byte can count
  const size_t lanes = hn::Lanes(words);
  auto sum = hn::Zero(words);
  while (i + lanes <= num_words) {
    const size_t end = i + std::min((num_words - i) / lanes, kMostPerByte) * lanes;
    auto sums = hn::Zero(bytes);
    for (; i < end; i += lanes) {
      const auto combined = combine(hn::LoadU(words, a + i), hn::LoadU(words, b + i));
      sums = hn::Add(sums, hn::PopulationCount(hn::BitCast(bytes, combined)));
    }
    sum = hn::Add(sum, hn::SumsOf8(sums));
  }
  total = static_cast<int64_t>(hn::GetLane(hn::SumOfLanes(words, sum)));
#endif
  for (; i < num_words; ++i) total += std::popcount(combine(a[i], b[i]));
  return total;
}

int64_t count_bits(const uint64_t* a, const uint64_t* b, size_t n) { return count(a, b, n, First()); }
int64_t count_xor(const uint64_t* a, const uint64_t* b, size_t n) { return count(a, b, n, Xor()); }
int64_t count_and(const uint64_t* a, const uint64_t* b, size_t n) { return count(a, b, n, And()); }
int64_t count_or(const uint64_t* a, const uint64_t* b, size_t n) { return count(a, b, n, Or()); }

}  // namespace silpose::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace silpose {

HWY_EXPORT(count_bits);
HWY_EXPORT(count_xor);
HWY_EXPORT(count_and);
HWY_EXPORT(count_or);

int64_t count_set_bits(std::span<const uint64_t> words) {
  return HWY_DYNAMIC_DISPATCH(count_bits)(words.data(), words.data(), words.size());
}
int64_t count_xor_bits(std::span<const uint64_t> a, std::span<const uint64_t> b) {
  return HWY_DYNAMIC_DISPATCH(count_xor)(a.data(), b.data(), a.size());
}
int64_t count_and_bits(std::span<const uint64_t> a, std::span<const uint64_t> b) {
  return HWY_DYNAMIC_DISPATCH(count_and)(a.data(), b.data(), a.size());
}
int64_t count_or_bits(std::span<const uint64_t> a, std::span<const uint64_t> b) {
  return HWY_DYNAMIC_DISPATCH(count_or)(a.data(), b.data(), a.size());
}

}  // namespace silpose
#endif  // HWY_ONCE
