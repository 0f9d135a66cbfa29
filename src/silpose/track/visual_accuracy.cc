#include "silpose/track/visual_accuracy.h"

namespace silpose {

double visual_accuracy(std::span<const BatchRenderer> renderers, std::span<const Observation> observations,
                       std::span<const double> pose) {
  for (size_t c = 0; c < observations.size(); ++c) {
    if (observations[c].trust.nothing_found) continue;
    return intersection_over_union(renderers[c].silhouette(pose), observations[c].mask);
  }
  return 0;
}

}  // namespace silpose
