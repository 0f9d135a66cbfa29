// LandmarkMatch: how well poses agree with landmarks that were found in the picture: pixels between where they are and
// where the body's are, robustly. Landmarks tell what a silhouette cannot, such as front from back and left from right;
// where exactly a joint is, they tell less well. Based on: Student's t by its weights (references.bib: lange1989).
// Threads: constant after construction.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "silpose/body/body_model.h"
#include "silpose/geometry/camera.h"
#include "silpose/shape/observation.h"

namespace silpose {

class LandmarkMatch {
 public:
  // The landmarks of an observation that a body has by name and that are seen within the picture; how far they may be
  // off goes with the mask's size. Keeps a reference to the body.
  LandmarkMatch(const BodyModel& body, const PinholeCamera& camera, const Observation& observation);

  [[nodiscard]] size_t size() const { return points_.size(); }
  // Too few of them tell nothing of the whole body.
  [[nodiscard]] bool tells_pose() const { return points_.size() >= 6; }

  // -2 log-likelihood of a pose [D], up to a constant.
  [[nodiscard]] double cost(std::span<const double> pose) const;

  // The same; adds to `gradient` [D] and `hessian` [D, D] of half of it (Gauss-Newton).
  double add(std::span<const double> pose, Eigen::VectorXd& gradient, Eigen::MatrixXd& hessian) const;

 private:
  struct Point {
    int joint_idx = 0;
    Eigen::Vector3d x_in_joint = Eigen::Vector3d::Zero();
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
    double weight = 1;
  };
  // What a landmark costs that is off by so many deviations, squared.
  static double cost_of(const Point& point, double squared);

  const BodyModel* body_;
  PinholeCamera camera_;
  std::vector<Point> points_;
  double deviation_px_ = 1;
};

}  // namespace silpose
