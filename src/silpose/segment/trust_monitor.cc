#include "silpose/segment/trust_monitor.h"

#include <algorithm>
#include <vector>

#include "silpose/base/median.h"

namespace silpose {
namespace {

// [guess] Half a second or so: a walker's area changes by a fifth in that time. A new level is accepted once it is the
// median.
constexpr size_t kWindow = 15, kLeast = 5;
constexpr double kMaxGrowth = 1.5;
constexpr double kTrustAtBorder = 0.5, kTrustAfterJump = 0.25;

}  // namespace

Observation TrustMonitor::judge(Mask mask, ByteImage confidence) {
  Observation result;
  Trust& trust = result.trust;
  if (ignored_) mask = without(std::move(mask), *ignored_);  // refined edges and --grow may reach into them
  const int64_t area = mask.count();
  const Box box = mask.bounding_box();
  trust.nothing_found = area == 0;
  trust.touches_border = area > 0 && (box.x == 0 || box.y == 0 || box.x + box.width == mask.width() ||
                                      box.y + box.height == mask.height());
  // Partly hidden behind ignored pixels the subject has a smaller area, which is no reason for less trust.
  if (area > 0 && !(ignored_ && are_adjacent(mask, *ignored_))) {
    if (recent_areas_.size() >= kLeast) {
      const auto usual =
          static_cast<double>(upper_median(std::vector<int64_t>(recent_areas_.begin(), recent_areas_.end())));
      const double ratio = static_cast<double>(area) / usual;
      trust.area_jumped = ratio > kMaxGrowth || ratio < 1 / kMaxGrowth;
    }
    recent_areas_.push_back(area);
    if (recent_areas_.size() > kWindow) recent_areas_.pop_front();
  }
  trust.overall = trust.nothing_found ? 0 : 1;
  if (trust.touches_border) trust.overall *= kTrustAtBorder;
  if (trust.area_jumped) trust.overall *= kTrustAfterJump;
  result.mask = std::move(mask);
  result.confidence = std::move(confidence);
  result.ignored = ignored_;
  return result;
}

}  // namespace silpose
