// Which inner edges of a mesh in strip order lie on its outline; included once for every instruction set by what lists
// them (outline_edges.cc on the grid, outline_spans.cc in pixels), after hwy/highway.h.

#if defined(SILPOSE_RENDER_STRIP_EDGES_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef SILPOSE_RENDER_STRIP_EDGES_INL_H_
#undef SILPOSE_RENDER_STRIP_EDGES_INL_H_
#else
#define SILPOSE_RENDER_STRIP_EDGES_INL_H_
#endif

#include <cstring>

#include "silpose/render/strip_view.h"

HWY_BEFORE_NAMESPACE();
namespace silpose {
namespace HWY_NAMESPACE {

// The edges between two faces that are turned to different sides: put(i, from, to) with positions in the strips, for i
// up to the number returned and up to 3 beyond it, which do not count. `winding`: a bit a position, 7 bytes more can be
// read; `found` [3 x runs or pairs] is scratch. Free of branches that depend on the data, but for runs with more than
// four of them: neither is predictable.
template <class Put>
HWY_INLINE size_t find_strip_edges(const StripView& strips, const uint8_t* HWY_RESTRICT winding,
                                   uint64_t* HWY_RESTRICT found, const Put& put) {
  constexpr uint64_t kNoneLeft = uint64_t{1} << 63;  // no run is as long
  const auto word_at = [&](uint32_t position) HWY_ATTR {
    uint64_t word;
    std::memcpy(&word, winding + position / 8, sizeof word);
    return word;
  };
  size_t num_found = 0;
  for (size_t r = 0; r < strips.num_runs; ++r) {
    const StripOrder::Run& run = strips.runs[r];
    const uint64_t first = word_at(run.first), other = word_at(run.other) >> (run.other % 8);
    const uint64_t differ = (first ^ other ^ run.expected) & run.mask;
    found[3 * num_found] = differ;
    found[3 * num_found + 1] = first;
    found[3 * num_found + 2] = r;
    num_found += static_cast<size_t>(differ != 0);
  }
  size_t count = 0;
  for (size_t f = 0; f < num_found; ++f) {
    uint64_t differ = found[3 * f];
    const uint64_t first = found[3 * f + 1];
    const StripOrder::Run& run = strips.runs[found[3 * f + 2]];
    const size_t start = run.first + StripOrder::kSide[run.side][0];
    const auto along = static_cast<int64_t>(StripOrder::kSide[run.side][1]) - StripOrder::kSide[run.side][0];
    const size_t end = count + hwy::PopCount(differ);
    do {
      for (size_t i = 0; i < 4; ++i) {
        const auto bit = static_cast<int64_t>(__builtin_ctzll(differ | kNoneLeft));  // 63: put, but not counted
        const int64_t turned = -static_cast<int64_t>(first >> bit & 1);
        put(count + i, start + static_cast<size_t>(bit + (along & turned)),
            start + static_cast<size_t>(bit + (along & ~turned)));
        differ &= differ - 1;
      }
      count += 4;
    } while (count < end);
    count = end;
  }
  size_t num_pairs = 0;
  for (size_t i = 0; i < strips.num_pairs; ++i) {
    const StripOrder::Pair pair = strips.pairs[i];
    const uint32_t first = pair.first(), other = pair.other();
    const uint32_t first_winding = winding[first / 8] >> (first % 8) & 1;
    const uint32_t other_winding = winding[other / 8] >> (other % 8);
    found[num_pairs] = uint64_t{pair.first_and_side} << 1 | first_winding;
    num_pairs += (first_winding ^ other_winding ^ pair.other_and_expected) & 1;
  }
  for (size_t i = 0; i < num_pairs; ++i) {
    const uint64_t turned = found[i] & 1, side = found[i] >> 1 & 3, first = found[i] >> 3;
    put(count++, first + StripOrder::kSide[side][turned], first + StripOrder::kSide[side][turned ^ 1]);
  }
  return count;
}

}  // namespace HWY_NAMESPACE
}  // namespace silpose
HWY_AFTER_NAMESPACE();

#endif  // target toggle
