// What is done with the spans of a silhouette: set them in a mask, count them against one, or find their bounds.
// Threads: pure functions.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>

#include "silpose/image/mask.h"
#include "silpose/render/outline_scan.h"

namespace silpose {

// Bits [begin, 64) and [0, end) of a word. REQUIRES: 0 <= begin < 64, 0 < end <= 64.
inline uint64_t bits_from(int begin) { return ~uint64_t{0} << begin; }
inline uint64_t bits_until(int end) { return ~uint64_t{0} >> (64 - end); }

// Set bits of a word without the POPCNT instruction, which the x86-64 baseline lacks.
inline int64_t count_bits(uint64_t word) {
  word -= (word >> 1) & 0x5555555555555555u;
  word = (word & 0x3333333333333333u) + ((word >> 2) & 0x3333333333333333u);
  word = (word + (word >> 4)) & 0x0f0f0f0f0f0f0f0fu;
  return static_cast<int64_t>((word * 0x0101010101010101u) >> 56);
}

// Calls visit(word index, bits) for the words of a mask row that pixels [x_begin, x_end) touch.
template <class Visit>
inline void for_each_word(int x_begin, int x_end, Visit&& visit) {
  const int first = x_begin >> 6, last = (x_end - 1) >> 6;
  uint64_t bits = bits_from(x_begin & 63);
  for (int word = first; word < last; ++word) {
    visit(static_cast<size_t>(word), bits);
    bits = ~uint64_t{0};
  }
  visit(static_cast<size_t>(last), bits & bits_until(((x_end - 1) & 63) + 1));
}

// Sets the scanned silhouette in a cleared mask of the scan's size.
inline void set_spans(OutlineScan& scan, Mask& mask) {
  scan.for_each_span([&](int y, int x_begin, int x_end) {
    const auto words = mask.row(y);
    for_each_word(x_begin, x_end, [&](size_t word, uint64_t bits) { words[word] |= bits; });
  });
}

// Counts the scanned silhouette against an observed mask of the scan's size.
inline OutlineRenderer::Counts count_spans(OutlineScan& scan, const Mask& observed) {
  OutlineRenderer::Counts counts;
  scan.for_each_span([&](int y, int x_begin, int x_end) {
    const auto words = observed.row(y);
    counts.model += x_end - x_begin;
    for_each_word(x_begin, x_end, [&](size_t word, uint64_t bits) { counts.both += count_bits(words[word] & bits); });
  });
  return counts;
}

// The box of the scanned silhouette's pixels; nothing when it has none.
inline std::optional<PixelBounds> bounds_of_spans(OutlineScan& scan) {
  std::optional<PixelBounds> bounds;
  scan.for_each_span([&](int y, int x_begin, int x_end) {
    if (!bounds) bounds = PixelBounds{.x0 = static_cast<double>(x_begin), .y0 = static_cast<double>(y)};
    bounds->x0 = std::min(bounds->x0, static_cast<double>(x_begin));
    bounds->x1 = std::max(bounds->x1, static_cast<double>(x_end));
    bounds->y1 = y + 1.0;
  });
  return bounds;
}

}  // namespace silpose
