// Girths: the flesh around each bone a little thicker or thinner than the body's builder said. Bones that are alike
// share one (both thighs: "thigh"). Threads: constant after construction.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "silpose/body/body_model.h"

namespace silpose {

class Girths {
 public:
  // Of a body with a closed mesh. A level of detail has the same ones.
  explicit Girths(BodyModel body);

  // [G] the groups of bones that have flesh, in joint order, named without their side.
  [[nodiscard]] const std::vector<std::string>& names() const { return names_; }

  // Prior covariance [G, G]: of the whole body's girth, and of each group's deviation from it.
  [[nodiscard]] Eigen::MatrixXd covariance() const;

  // The body whose flesh reaches further from each bone's middle line by `girths` [G], shares: 0.1 is a tenth thicker.
  // Joints stay where they are; the mass follows the volume. Errors: throws std::invalid_argument for another number
  // of girths, or one of -1 and below.
  [[nodiscard]] BodyModel applied(std::span<const double> girths) const;

 private:
  // The middle line of a bone's flesh in the rest pose, and the group it belongs to; -1: no flesh.
  struct Bone {
    Eigen::Vector3d point = Eigen::Vector3d::Zero(), direction = Eigen::Vector3d::UnitY();
    int group = -1;
  };
  BodyModel body_;
  std::vector<Bone> bones_;  // [J]
  std::vector<std::string> names_;
  double volume_ = 0;
};

}  // namespace silpose
