#include "silpose/image/observation.h"

#include <algorithm>

#include "silpose/base/check.h"

namespace silpose {

void check_sizes(const Observation& observation) {
  const Mask& mask = observation.mask;
  const auto check_size = [&](const char* what, int width, int height) {
    check(width == mask.width() && height == mask.height(), "observation: {} of {}x{} for a mask of {}x{}", what, width,
          height, mask.width(), mask.height());
  };
  if (!observation.confidence.empty()) {
    check_size("confidence", observation.confidence.width(), observation.confidence.height());
  }
  if (observation.depth) check_size("depth", observation.depth->width(), observation.depth->height());
  if (observation.ignored) check_size("ignored pixels", observation.ignored->width(), observation.ignored->height());
}

bool is_usable(const Observation& observation) {
  return !observation.trust.nothing_found && observation.trust.overall >= kLeastTrust && !observation.box().empty();
}

bool any_is_usable(std::span<const Observation> observations) { return std::ranges::any_of(observations, is_usable); }

}  // namespace silpose
