#include "silpose/render/coverage_count.h"

#include <algorithm>

#include "silpose/base/check.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "silpose/render/coverage_count.cc"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace silpose {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

static_assert(kCoverageSamples == 8 && kFullCoverage == 64);  // a byte's bits are a pixel's samples in one row

#if HWY_TARGET == HWY_SCALAR

uint64_t count_in_bytes(uint64_t bits) {
  bits -= bits >> 1 & 0x5555555555555555u;
  bits = (bits & 0x3333333333333333u) + (bits >> 2 & 0x3333333333333333u);
  return (bits + (bits >> 4)) & 0x0f0f0f0f0f0f0f0fu;
}

HWY_INLINE uint64_t coverage_of_rows(const uint64_t* HWY_RESTRICT rows) {
  uint64_t sum = 0;
  for (size_t i = 0; i < 8; ++i) sum += count_in_bytes(rows[i]);
  return sum;
}

HWY_INLINE void add_coverage(const uint64_t* HWY_RESTRICT model, const uint64_t* HWY_RESTRICT observed, size_t count,
                             int64_t& all, int64_t& common) {
  for (size_t i = 0; i < count; ++i) {
    for (int shift = 0; shift < 64; shift += 8) {
      const uint64_t of_model = model[i] >> shift & 255, of_observed = observed[i] >> shift & 255;
      all += static_cast<int64_t>(of_model);
      common += static_cast<int64_t>(HWY_MIN(of_model, of_observed));
    }
  }
}

#else

// Eight rows of eight pixels' samples to the eight pixels' coverages, a byte each: no byte overflows.
HWY_INLINE uint64_t coverage_of_rows(const uint64_t* HWY_RESTRICT rows) {
  const hn::CappedTag<uint64_t, 8> words;
  const hn::Repartition<uint8_t, decltype(words)> bytes;
  auto sum = hn::Zero(words);
  for (size_t i = 0; i < 8; i += hn::Lanes(words)) {
    const auto in_bytes = hn::PopulationCount(hn::BitCast(bytes, hn::LoadU(words, rows + i)));
    sum = hn::Add(sum, hn::BitCast(words, in_bytes));
  }
  return hn::GetLane(hn::SumOfLanes(words, sum));
}

// `count`: up to 8; what lies beyond is zero and can be read.
HWY_INLINE void add_coverage(const uint64_t* HWY_RESTRICT model, const uint64_t* HWY_RESTRICT observed, size_t count,
                             int64_t& all, int64_t& common) {
  const hn::CappedTag<uint64_t, 8> words;
  const hn::Repartition<uint8_t, decltype(words)> bytes;
  auto of_model = hn::Zero(words), of_both = of_model;
  for (size_t i = 0; i < count; i += hn::Lanes(words)) {
    const auto m = hn::BitCast(bytes, hn::LoadU(words, model + i));
    const auto o = hn::BitCast(bytes, hn::LoadU(words, observed + i));
    of_model = hn::Add(of_model, hn::SumsOf8(m));
    of_both = hn::Add(of_both, hn::SumsOf8(hn::Min(m, o)));
  }
  all += static_cast<int64_t>(hn::GetLane(hn::SumOfLanes(words, of_model)));
  common += static_cast<int64_t>(hn::GetLane(hn::SumOfLanes(words, of_both)));
}

#endif

// `observed` [words, height] can be read 8 beyond its end.
void count_coverage(const OutlineScan::Bits& samples, const uint64_t* HWY_RESTRICT observed, size_t height,
                    int64_t* model, int64_t* both) {
  constexpr size_t kBlock = 8;
  int64_t all = 0, common = 0;
  const auto row_begin = static_cast<size_t>(samples.row_begin), row_end = static_cast<size_t>(samples.row_end);
  const size_t begin = row_begin / 8, end = (row_end + 7) / 8;  // of pixels
  for (auto w = static_cast<size_t>(samples.word_begin); w < static_cast<size_t>(samples.word_end); ++w) {
    const uint64_t* const column = samples.words + w * static_cast<size_t>(samples.height);
    for (size_t first = begin; first < end; first += kBlock) {
      const size_t count = HWY_MIN(kBlock, end - first);
      uint64_t coverage[kBlock] = {};
      for (size_t i = 0; i < count; ++i) {
        const size_t row = 8 * (first + i);
        if (row >= row_begin && row + 8 <= row_end) {
          coverage[i] = coverage_of_rows(column + row);
          continue;
        }
        uint64_t rows[8] = {};  // what lies outside of the part in use means nothing
        for (size_t r = HWY_MAX(row, row_begin); r < HWY_MIN(row + 8, row_end); ++r) rows[r - row] = column[r];
        coverage[i] = coverage_of_rows(rows);
      }
      add_coverage(coverage, observed + w * height + first, count, all, common);
    }
  }
  *model = all;
  *both = common;
}

}  // namespace HWY_NAMESPACE
}  // namespace silpose
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace silpose {

HWY_EXPORT(count_coverage);

CoverageColumns::CoverageColumns(const ByteImage& coverage) : width_(coverage.width()), height_(coverage.height()) {
  check(coverage.channels() == 1, "CoverageColumns: {} channels", coverage.channels());
  constexpr size_t kSpare = 8;
  const auto height = static_cast<size_t>(height_);
  words_.assign(static_cast<size_t>((width_ + 7) / 8) * height + kSpare, 0);
  for (size_t y = 0; y < height; ++y) {
    const auto row = coverage.row(static_cast<int>(y));
    for (size_t x = 0; x < row.size(); ++x) {
      check(row[x] <= kFullCoverage, "CoverageColumns: {} of {} samples", row[x], kFullCoverage);
      words_[x / 8 * height + y] |= uint64_t{row[x]} << (8 * (x % 8));
    }
  }
}

OutlineRenderer::Counts CoverageColumns::count(const OutlineScan::Bits& samples) const {
  check(samples.width == kCoverageSamples * width_ && samples.height == kCoverageSamples * height_,
        "CoverageColumns: {}x{} samples for {}x{} pixels", samples.width, samples.height, width_, height_);
  OutlineRenderer::Counts counts;
  HWY_DYNAMIC_DISPATCH(count_coverage)
  (samples, words_.data(), static_cast<size_t>(height_), &counts.model, &counts.both);
  return counts;
}

}  // namespace silpose
#endif  // HWY_ONCE
