#include "silpose/shape/distance.h"

namespace silpose {

int64_t pixel_count_distance(const Mask& a, const Mask& b) { return xor_count(a, b); }

double pixel_count_fraction(const Mask& a, const Mask& b) {
  return pixel_count_fraction(a.count(), b.count(), and_count(a, b));
}

double pixel_count_fraction(int64_t model, int64_t observed, int64_t both) {
  const int64_t areas = model + observed;
  return areas == 0 ? 0.0 : static_cast<double>(areas - 2 * both) / static_cast<double>(areas);
}

}  // namespace silpose
