// PoseFilter: what a tracker drives, frame by frame: a set of weighted poses that follows the observations.
//
// Contract: start() before anything else, and again after losing the subject. step() takes the observations; coast() is
// for an instant without a usable observation. After each, particles() holds states whose first D columns are poses
// within the limits, estimate() one pose made of them, and spread() how far the truth may be from it. The same seed and
// calls give the same states on any number of threads.
//
// Threads: one thread per filter; steps use all cores inside.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "silpose/filter/particle_set.h"
#include "silpose/fit/initialisation.h"
#include "silpose/fit/pose_spread.h"
#include "silpose/image/observation.h"
#include "silpose/track/step_report.h"

namespace silpose {

class PoseFilter {
 public:
  virtual ~PoseFilter() = default;

  // Starts over around poses, best first; a filter may take the first alone. REQUIRES: at least one.
  virtual void start(std::span<const StartingPose> starts) = 0;

  // Takes poses found elsewhere into account from the next step on. A filter that cannot use them ignores them.
  virtual void add(std::span<const StartingPose> starts) { (void)starts; }

  // Shapes: one observation per camera, at least one of them usable; `dt_s` seconds since the last call.
  virtual FilterReport step(std::span<const Observation> observations, double dt_s, StepSeconds& seconds) = 0;
  virtual FilterReport coast(double dt_s) = 0;

  [[nodiscard]] virtual const ParticleSet& particles() const = 0;  // states [N, D' >= D]
  [[nodiscard]] virtual std::vector<double> estimate() const = 0;  // [D]
  [[nodiscard]] virtual PoseSpread spread() const = 0;
  // The estimate [D] as it is expected to be in `dt_s`, within the limits; the estimate where a filter knows no
  // velocities.
  [[nodiscard]] virtual std::vector<double> predict(double dt_s) const {
    (void)dt_s;
    return estimate();
  }
  // Outline noise that was found, in units of pixel_unit^3 [C]; empty where a filter does not look.
  [[nodiscard]] virtual std::vector<double> noise() const { return {}; }

  // State from which another filter with the same options, body and cameras continues exactly as this one would.
  // Errors: restore() throws std::invalid_argument for what is no such state.
  [[nodiscard]] virtual std::string state() const = 0;
  virtual void restore(std::string_view state) = 0;
};

}  // namespace silpose
