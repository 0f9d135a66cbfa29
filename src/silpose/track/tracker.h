// Tracker: the method. One step per frame: predict, fit or sample, weigh by silhouettes and keypoints,
// estimate. No I/O.
// Filters: a mixture of hypotheses, each fitted to the silhouettes and predicted at constant velocity
// (mixture_filter.h: bell1993, sminchisescu2003), which track_clip() can smooth over the clip; one particle filter over
// root and pose together, plain or annealed (deutscher2005); two plain ones for root and pose (cormier2019 sect. 2.4;
// martinez2008). tracker_presets.h has a set of options for each.
// Threads: one thread steps a tracker; a step itself uses all cores and gives the same result on any number.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "silpose/filter/state_batch.h"
#include "silpose/image/mask.h"
#include "silpose/image/observation.h"
#include "silpose/track/step_report.h"
#include "silpose/track/tracker_options.h"

namespace silpose {

class Tracker {
 public:
  // Errors: throws std::invalid_argument as TrackerOptions::check().
  explicit Tracker(const TrackerOptions& options);
  ~Tracker();
  Tracker(Tracker&&) noexcept;
  Tracker& operator=(Tracker&&) noexcept;

  // Tracks one instant from masks. Shapes: one observation per camera. Times must grow.
  StepReport step(std::span<const Observation> observations, int64_t frame_idx, int64_t time_ns);

  // Silhouettes of the estimate, extrapolated at its velocity by `dt_s`, on a coarse mesh: [C]. Empty before the start
  // and while it coasts.
  [[nodiscard]] std::vector<Mask> expected(double dt_s) const;

  [[nodiscard]] const TrackerOptions& options() const;
  // The current particles [N, D' >= D] and their log weights [N]. Those of fitted hypotheses are poses, then velocities
  // per second: D' = 2 D.
  [[nodiscard]] const StateBatch& particles() const;
  [[nodiscard]] std::span<const double> log_weights() const;
  // Outline noise that the fitted filter found, in units of pixel_unit^3 (likelihood/coverage_likelihood.h). [C], or
  // empty.
  [[nodiscard]] std::vector<double> noise() const;

  // State from which another tracker with the same options continues exactly as this one would: the same reports, bit
  // for bit, from the same program.
  // Errors: restore() throws std::invalid_argument for what is no such state.
  [[nodiscard]] std::string state() const;
  void restore(std::string_view state);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace silpose
