#include <array>
#include <bit>
#include <opencv2/core.hpp>

#include "benches.h"
#include "silpose/base/rng.h"
#include "silpose/image/mask.h"

namespace silpose::bench {
namespace {

// One word at a time, by the processor's own instruction for it where there is one.
#if defined(__x86_64__) && defined(__GNUC__)
__attribute__((target("popcnt")))
#endif
#if defined(__GNUC__) && !defined(__clang__)
__attribute__((optimize("no-tree-vectorize")))
#endif
int64_t
scalar_xor_count(std::span<const uint64_t> a, std::span<const uint64_t> b) {
  int64_t count = 0;
  for (size_t i = 0; i < a.size(); ++i) count += __builtin_popcountll(a[i] ^ b[i]);
  return count;
}

Figure xor_us(int size, int rounds) {
  Rng rng(1);
  Mask a(size, size), b(size, size);
  cv::Mat bytes_a(size, size, CV_8U), bytes_b(size, size, CV_8U), difference;
  for (int y = 0; y < size; ++y) {
    for (int x = 0; x < size; ++x) {
      a.set(x, y, rng.index(2) != 0);
      b.set(x, y, rng.index(2) != 0);
      bytes_a.at<uint8_t>(y, x) = a.get(x, y);
      bytes_b.at<uint8_t>(y, x) = b.get(x, y);
    }
  }
  cv::bitwise_xor(bytes_a, bytes_b, difference);
  const int64_t differing = cv::countNonZero(difference);
  verify(xor_count(a, b) == differing && scalar_xor_count(a.words(), b.words()) == differing, "XOR count");

  constexpr int kRepeats = 20000;
  constexpr double kAmount = kRepeats / 1e6;  // seconds per amount are microseconds per count
  const Contestant ours{.name = "ours", .amount = kAmount, .run = [&] {
                          for (int i = 0; i < kRepeats; ++i) keep(xor_count(a, b));
                        }};
  const std::array peers = {
      Contestant{.name = "scalar popcount, one word at a time",
                 .amount = kAmount,
                 .run =
                     [&] {
                       for (int i = 0; i < kRepeats; ++i) keep(scalar_xor_count(a.words(), b.words()));
                     }},
      Contestant{.name = "OpenCV bitwise_xor and countNonZero on bytes", .amount = kAmount, .run = [&] {
                   for (int i = 0; i < kRepeats; ++i) {
                     cv::bitwise_xor(bytes_a, bytes_b, difference);
                     keep(cv::countNonZero(difference));
                   }
                 }}};
  return measure({.unit = "us", .higher_is_better = false, .rounds = rounds}, ours, peers);
}

}  // namespace

Figure xor_128_us(int rounds) { return xor_us(128, rounds); }
Figure xor_256_us(int rounds) { return xor_us(256, rounds); }

}  // namespace silpose::bench
