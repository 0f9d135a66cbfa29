// levenberg_marquardt(): damped Gauss-Newton for any problem that linearises itself: a step that lowers the cost is
// kept and the next one damped less; one that does not is tried again, shorter. Based on: the damping of Levenberg and
// Marquardt (references.bib: nocedal2006). Threads: a function without state.
#pragma once

#include <cmath>
#include <optional>
#include <utility>

namespace silpose {

// A gain smaller than this ends a descent.
struct SmallestGain {
  double absolute = 0;
  double relative = 0;  // to the cost
};

// At most `max_iterations` steps from `at`, which has a cost(). `step(at, damping)` returns the point after a step from
// `at` whose normal matrix has its diagonal multiplied by 1 + damping, as std::optional: nothing ends the descent.
template <class Point, class Step>
void levenberg_marquardt(Point& at, int max_iterations, const SmallestGain& smallest, const Step& step) {
  constexpr double kFirstDamping = 1e-3, kLessDamping = 0.2, kMoreDamping = 8;
  double damping = kFirstDamping;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    std::optional<Point> next = step(std::as_const(at), damping);
    if (!next) return;
    const double gain = at.cost() - next->cost();
    if (gain > 0) {
      at = std::move(*next);
      damping *= kLessDamping;
    } else {
      damping *= kMoreDamping;
    }
    if (std::abs(gain) < smallest.absolute + smallest.relative * at.cost()) return;
  }
}

}  // namespace silpose
