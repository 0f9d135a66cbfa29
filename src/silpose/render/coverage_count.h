// How much of each pixel a silhouette covers, counted: it is drawn kCoverageSamples times finer along both axes, and a
// pixel's coverage is the number of its samples inside, 0 to kFullCoverage. Overlaps count once, as in any silhouette.
// Against the exact area, of a straight edge: off by a sixteenth of the pixel at most, where the edge is upright or
// level; hardly at all where it slants.
// By Highway, built for every instruction set and chosen at run time; the same for all of them.
// Threads: values and pure functions.
#pragma once

#include <cstdint>
#include <vector>

#include "silpose/image/image.h"
#include "silpose/render/outline_scan.h"
#include "silpose/render/silhouette.h"
#include "silpose/shape/window.h"

namespace silpose {

// An observation's coverages as kernels read them: eight pixels of a row per word, word columns of all rows one after
// the other.
class CoverageColumns {
 public:
  explicit CoverageColumns(const ByteImage& coverage);  // values up to kFullCoverage

  // REQUIRES: of a silhouette in the sample_window() of this size.
  [[nodiscard]] OutlineRenderer::Counts count(const OutlineScan::Bits& samples) const;

 private:
  int width_, height_;
  std::vector<uint64_t> words_;  // [ceil(width / 8), height]
};

}  // namespace silpose
