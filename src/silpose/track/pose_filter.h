// PoseFilter: what a tracker drives, frame by frame: a set of weighted poses that follows the observations.
//
// Contract: start() before anything else, and again after losing the subject. step() takes what was seen; coast() is for
// an instant without a usable observation. After each, particles() holds states whose first D columns are poses within
// the limits, and estimate() one pose made of them. The same seed and calls give the same states on any number of threads.
//
// Threads: one thread per filter; steps use all cores inside.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "silpose/filter/particle_set.h"
#include "silpose/render/silhouette.h"
#include "silpose/shape/observation.h"
#include "silpose/track/step_report.h"
#include "silpose/track/tracker_options.h"

namespace silpose {

class PoseFilter {
 public:
  virtual ~PoseFilter() = default;

  // Starts over around a pose [D].
  virtual void start(std::span<const double> pose) = 0;

  // Shapes: one observation a camera, at least one with a say; `dt_s` seconds since the last call.
  virtual FilterReport step(std::span<const Observation> observations, double dt_s, StepSeconds& seconds) = 0;
  virtual FilterReport coast(double dt_s) = 0;

  [[nodiscard]] virtual const ParticleSet& particles() const = 0;  // states [N, D' >= D]
  [[nodiscard]] virtual std::vector<double> estimate() const = 0;  // [D]
};

// The filter of `options.preset`, on the renderers of the tracker's level of detail, one a camera.
// Errors: throws std::invalid_argument as TrackerOptions::check().
std::unique_ptr<PoseFilter> make_pose_filter(const TrackerOptions& options,
                                             std::vector<std::shared_ptr<const BatchRenderer>> renderers);

}  // namespace silpose
