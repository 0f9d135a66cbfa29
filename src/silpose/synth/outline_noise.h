// OutlineNoise: outlines displaced as segmentation displaces them: outwards here, inwards there, changing slowly along
// the outline and over time. The displacement is a Gaussian field over place, outline direction and time, so that the
// two sides of a limb err apart; correlation falls to exp(-1/2) at one correlation length, and at one correlation time.
// Based on: random Fourier features of a Gaussian kernel (references.bib: rahimi2007).
// Threads: const functions are safe.
#pragma once

#include <cstdint>
#include <vector>

#include "silpose/image/mask.h"

namespace silpose {

struct OutlineNoiseOptions {
  double correlation_length = 0.1;  // of the body's height
  double correlation_time_s = 0.3;
  double bias = 0;  // mean displacement outwards, in standard deviations of the displacement; negative shrinks
};

class OutlineNoise {
 public:
  // Largest amplitude asked about: standard deviation of the displacement, of the body's height.
  static constexpr double kLargestAmplitude = 0.05;

  // Cameras that see one sequence have noise of their own: `stream`.
  OutlineNoise(const OutlineNoiseOptions& options, uint64_t seed, uint64_t stream);

  // A pixel that is not as in the true mask wherever the amplitude is larger than `amplitude` (of the body's height).
  struct Change {
    int x = 0, y = 0;
    double amplitude = 0;
  };

  // All of them up to the largest amplitude; displacements end at 12 % of the height. Places are relative to the middle
  // of the mask. `height_px`: of the body, as far away as it is.
  [[nodiscard]] std::vector<Change> changes(const Mask& truth, double height_px, double time_s) const;

 private:
  struct Wave {
    double x = 0, y = 0, normal_x = 0, normal_y = 0, time = 0, phase = 0;  // per height, -, -, per second, radians
  };
  double bias_;
  std::vector<Wave> waves_;
};

}  // namespace silpose
