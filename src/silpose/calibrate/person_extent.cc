#include "silpose/calibrate/person_extent.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace silpose {
namespace {

constexpr int kLeastHeight = 24;             // pixels of a mask that is informative
constexpr double kWidest = 1.3;              // of its height: a mask that is wider lies
constexpr double kTrunk[] = {0.25, 0.5};     // rows of it, in parts of the height from the top
constexpr double kHeadReach = 0.08;          // of the height: how far off the trunk's middle a head may be
constexpr double kLegs = 0.2, kHead = 0.08;  // rows whose middle is taken, from below and from above

// Middle of the set pixels of some rows, from column `begin` to `end`. Nothing where there is none.
std::optional<double> middle_of_rows(const Mask& mask, int first, int last, int begin, int end) {
  int64_t count = 0, sum = 0;
  for (int y = first; y <= last; ++y) {
    for (int x = begin; x < end; ++x) {
      if (mask.get(x, y)) sum += x, ++count;
    }
  }
  if (count == 0) return std::nullopt;
  return static_cast<double>(sum) / static_cast<double>(count) + 0.5;
}

}  // namespace

std::optional<PersonExtent> person_extent(const Mask& mask) {
  const Box box = mask.bounding_box();
  if (box.height < kLeastHeight || box.width > kWidest * box.height) return std::nullopt;
  if (box.x == 0 || box.y == 0 || box.x + box.width == mask.width() || box.y + box.height == mask.height()) {
    return std::nullopt;
  }
  const auto row = [&](double part) { return box.y + static_cast<int>(part * box.height); };
  const auto trunk = middle_of_rows(mask, row(kTrunk[0]), row(kTrunk[1]), box.x, box.x + box.width);
  if (!trunk) return std::nullopt;
  const double reach = kHeadReach * box.height;
  const int begin = std::max(box.x, static_cast<int>(*trunk - reach));
  const int end = std::min(box.x + box.width, static_cast<int>(*trunk + reach) + 1);
  int top = box.y;
  while (!middle_of_rows(mask, top, top, begin, end)) {
    if (++top > row(kTrunk[1])) return std::nullopt;
  }
  const int head_rows = std::max(1, static_cast<int>(kHead * box.height));
  const int legs_from = box.y + box.height - std::max(1, static_cast<int>(kLegs * box.height));
  const int bottom = box.y + box.height;
  int left = mask.width(), right = 0;
  for (int y = legs_from; y < bottom; ++y) {
    for (int x = box.x; x < box.x + box.width; ++x) {
      if (mask.get(x, y)) left = std::min(left, x), right = std::max(right, x + 1);
    }
  }
  const double head_x = middle_of_rows(mask, top, top + head_rows - 1, begin, end).value();
  PersonExtent extent{0, {head_x, top}, {0.5 * (left + right), bottom}};
  extent.slenderness = extent.height() / std::sqrt(static_cast<double>(mask.count()));
  return extent;
}

}  // namespace silpose
