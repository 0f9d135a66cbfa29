#include "silpose/shape/distance.h"

#include "silpose/base/check.h"

namespace silpose {

double depth_ssd(const Image<float>& a, const Image<float>& b, double missing_m) {
  check(a.width() == b.width() && a.height() == b.height() && a.channels() == 1 && b.channels() == 1,
        "depth_ssd: images of {}x{}x{} and {}x{}x{}", a.width(), a.height(), a.channels(), b.width(), b.height(),
        b.channels());
  double sum = 0;
  for (size_t i = 0; i < a.pixels().size(); ++i) {
    const double in_a = a.pixels()[i], in_b = b.pixels()[i];
    const double difference = (in_a == 0) == (in_b == 0) ? in_a - in_b : missing_m;
    sum += difference * difference;
  }
  return sum;
}

}  // namespace silpose
