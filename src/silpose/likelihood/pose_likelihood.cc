#include "silpose/likelihood/pose_likelihood.h"

#include "silpose/base/check.h"

namespace silpose {

NormalEquations PoseLikelihood::linearise(const Evidence&, std::span<const double>) const {
  throw std::logic_error("PoseLikelihood: this one has no linearisation");
}

void check_number(std::span<const Observation> observations, size_t num_cameras) {
  check(observations.size() == num_cameras, "PoseLikelihood: {} observations for {} cameras", observations.size(),
        num_cameras);
}

void check_fits(const Observation& observation, const PinholeCamera& camera) {
  check(observation.mask.width() == camera.width && observation.mask.height() == camera.height,
        "PoseLikelihood: mask of {}x{} for camera '{}' of {}x{}", observation.mask.width(), observation.mask.height(),
        camera.name, camera.width, camera.height);
  check_sizes(observation);
}

void check_batch(const BodyModel& body, const StateBatch& states, std::span<const double> out) {
  check(std::ssize(out) == states.rows(), "PoseLikelihood: {} outputs for {} states", out.size(), states.rows());
  check(states.cols() >= body.skeleton.num_dofs(), "PoseLikelihood: states of {} columns, body of {} DOF",
        states.cols(), body.skeleton.num_dofs());
}

}  // namespace silpose
