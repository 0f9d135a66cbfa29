#include "silpose/segment/depth_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "silpose/base/parallel.h"

namespace silpose {
namespace {

constexpr uint16_t kUnknown = std::numeric_limits<uint16_t>::max();
constexpr size_t kStrayFar = 20;  // [guess] one in this many depths may be too far by mistake

// What the background may seem nearer by, metres: a few deviations of a structured-light sensor, which grow with the
// square of the depth, and a margin for edges and steps.
double tolerance(double depth_m) { return 0.03 + 0.006 * depth_m * depth_m; }

template <class Test>
Mask select(const DepthImage& depth, const Test& test) {
  Mask mask(depth.width(), depth.height());
  parallel_for(static_cast<size_t>(depth.height()), 32, [&](size_t begin, size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      const auto row = depth.row(y);
      const auto words = mask.row(y);
      for (size_t x = 0; x < row.size(); ++x) {
        if (row[x] != 0 && test(x, y, row[x])) words[x / 64] |= uint64_t{1} << (x % 64);
      }
    }
  });
  return mask;
}

}  // namespace

DepthImage learn_depth_background(std::span<const DepthImage> images) {
  check(!images.empty(), "learn_depth_background: no images");
  DepthImage background(images[0].width(), images[0].height());
  parallel_for(static_cast<size_t>(background.height()), 8, [&](size_t begin, size_t end) {
    std::vector<uint16_t> seen;
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      for (int x = 0; x < background.width(); ++x) {
        seen.clear();
        for (const DepthImage& image : images) {
          if (image.at(x, y) != 0) seen.push_back(image.at(x, y));
        }
        background.at(x, y) = kUnknown;
        if (2 * seen.size() < images.size()) continue;
        const auto far = seen.end() - 1 - static_cast<ptrdiff_t>(seen.size() / kStrayFar);
        std::nth_element(seen.begin(), far, seen.end());
        background.at(x, y) = *far;
      }
    }
  });
  return background;
}

Mask nearer_than_background(const DepthImage& depth, const DepthImage& background) {
  check(depth.width() == background.width() && depth.height() == background.height(),
        "nearer_than_background: {}x{} before {}x{}", depth.width(), depth.height(), background.width(),
        background.height());
  std::vector<uint16_t> nearest(background.pixels().begin(), background.pixels().end());
  for (uint16_t& value : nearest) {
    const double metres = 1e-3 * value;
    if (value != kUnknown) value = static_cast<uint16_t>(std::max(0.0, 1000 * (metres - tolerance(metres))));
  }
  const auto width = static_cast<size_t>(depth.width());
  return select(depth,
                [&](size_t x, int y, uint16_t value) { return value < nearest[static_cast<size_t>(y) * width + x]; });
}

Image<float> depth_evidence(const DepthImage& depth, const DepthImage& background) {
  check(depth.width() == background.width() && depth.height() == background.height(),
        "depth_evidence: {}x{} before {}x{}", depth.width(), depth.height(), background.width(), background.height());
  constexpr float kMaxFor = 6;                     // [guess] so that neighbours can outvote it
  constexpr double kDeviations = 3;                // [guess] the tolerance is this many
  constexpr double kSubjectRange_m = 4 / 2.50663;  // [guess] the subject may be anywhere in 4 m; over sqrt(2 pi)
  Image<float> evidence(depth.width(), depth.height());
  parallel_for(static_cast<size_t>(depth.height()), 32, [&](size_t begin, size_t end) {
    for (int y = static_cast<int>(begin); y < static_cast<int>(end); ++y) {
      const auto seen = depth.row(y), behind = background.row(y);
      const auto to = evidence.row(y);
      for (size_t x = 0; x < seen.size(); ++x) {
        if (seen[x] == 0) continue;
        if (behind[x] == kUnknown) {
          to[x] = kMaxFor;
          continue;
        }
        // What is farther than the background is background: the subject was here while it was learned.
        const double deviation = tolerance(1e-3 * behind[x]) / kDeviations;
        const double nearer = std::max(0, behind[x] - seen[x]) * 1e-3 / deviation;
        const double odds = 0.5 * nearer * nearer - std::log(kSubjectRange_m / deviation);
        to[x] = static_cast<float>(std::min<double>(odds, kMaxFor));
      }
    }
  });
  return evidence;
}

Mask within_depth_range(const DepthImage& depth, const DepthRange& range) {
  return select(depth, [&](size_t, int, uint16_t value) {
    return value >= std::lround(1000 * range.min_m) && value <= std::lround(1000 * range.max_m);
  });
}

}  // namespace silpose
