#include "silpose/likelihood/pose_likelihood.h"

#include "silpose/base/check.h"

namespace silpose {

NormalEquations PoseLikelihood::linearise(const Evidence&, std::span<const double>) const {
  throw std::logic_error("PoseLikelihood: this one has no linearisation");
}

void check_batch(const BodyModel& body, const StateBatch& states, std::span<const double> out) {
  check(std::ssize(out) == states.rows(), "PoseLikelihood: {} outputs for {} states", out.size(), states.rows());
  check(states.cols() >= body.skeleton.num_dofs(), "PoseLikelihood: states of {} columns, body of {} DOF",
        states.cols(), body.skeleton.num_dofs());
}

}  // namespace silpose
