#include "silpose/track/observe.h"

#include <utility>

namespace silpose {

Observation observation_from(Segmentation segmentation) {
  Observation observation;
  observation.box = segmentation.mask.bounding_box();
  observation.trust = {.overall = segmentation.trust,
                       .nothing_found = segmentation.nothing_found,
                       .touches_border = segmentation.touches_border,
                       .area_jumped = segmentation.area_jumped};
  observation.mask = std::move(segmentation.mask);
  return observation;
}

}  // namespace silpose
