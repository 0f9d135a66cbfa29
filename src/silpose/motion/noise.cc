#include "silpose/motion/noise.h"

#include <cmath>

#include "silpose/base/check.h"

namespace silpose {

std::vector<double> noise_deviation(const RigProfile& profile, double sigma_deg) {
  check(std::isfinite(sigma_deg) && sigma_deg > 0, "noise: sigma of {} degrees", sigma_deg);
  std::vector<double> deviation = profile.noise;
  for (double& value : deviation) value = value * sigma_deg / kTypicalSigmaDeg;
  return deviation;
}

}  // namespace silpose
