#include "silpose/track/visual_accuracy.h"

namespace silpose {

double visual_accuracy(std::span<const BatchRenderer> renderers, std::span<const Observation> observations,
                       std::span<const double> pose) {
  for (size_t c = 0; c < observations.size(); ++c) {
    const Observation& seen = observations[c];
    if (seen.trust.nothing_found) continue;
    const Mask silhouette = renderers[c].silhouette(pose);
    if (!seen.ignored) return intersection_over_union(silhouette, seen.mask);
    return intersection_over_union(seen.known(silhouette), seen.known(seen.mask));
  }
  return 0;
}

}  // namespace silpose
