#include "silpose/track/observe.h"

#include <algorithm>
#include <utility>

namespace silpose {
namespace {

// Every pixel keeps half of its weight: where a whole outline is doubted, a fit goes to where it need not explain it.
constexpr int kLeastSure = 128;

}  // namespace

Observation observation_from(Segmentation segmentation) {
  Observation observation;
  observation.box = segmentation.mask.bounding_box();
  observation.trust = {.overall = segmentation.trust,
                       .nothing_found = segmentation.nothing_found,
                       .touches_border = segmentation.touches_border,
                       .area_jumped = segmentation.area_jumped};
  observation.mask = std::move(segmentation.mask);
  observation.landmarks = std::move(segmentation.landmarks);
  observation.keypoints = std::move(segmentation.keypoints);
  observation.confidence = std::move(segmentation.confidence);
  for (uint8_t& sure : observation.confidence.pixels()) sure = static_cast<uint8_t>(kLeastSure + sure / 2);
  return observation;
}

bool is_usable(const Observation& observation) {
  return !observation.trust.nothing_found && !observation.box.empty() && observation.trust.overall >= kLeastTrust;
}

bool any_is_usable(std::span<const Observation> observations) { return std::ranges::any_of(observations, is_usable); }

double visual_accuracy(std::span<const BatchRenderer> renderers, std::span<const Observation> observations,
                       std::span<const double> pose) {
  for (size_t c = 0; c < observations.size(); ++c) {
    if (observations[c].trust.nothing_found) continue;
    return intersection_over_union(renderers[c].silhouette(pose), observations[c].mask);
  }
  return 0;
}

}  // namespace silpose
