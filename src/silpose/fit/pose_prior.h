// PosePrior: what is known of a pose before any image: joints stay within their limits and near rest, the body
// does not pass through itself, and nothing of it lies just below the floor y = 0 (where any point lies deep below, the
// floor is assumed to be elsewhere, and nothing is pushed). Derived from mesh and skeleton of any body.
// All of it is soft: least squares, as the fit of the silhouette uses. Threads: constant after construction.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "silpose/body/collision_spheres.h"
#include "silpose/body/point_motion.h"

namespace silpose {

// How strongly poses are held near rest.
struct RestPull {
  double weight = 1;             // 1 for a single pose, less for one of many similar ones
  bool directions_seen = false;  // of limbs, by keypoints: what is measured is constrained less
};

class PosePrior {
 public:
  PosePrior(std::shared_ptr<const BodyModel> body, bool floor);

  // Cost of a pose [D]; adds to `gradient` [D] and `hessian` [D, D] of half of it.
  double add(const Eigen::VectorXd& pose, const RestPull& rest, Eigen::VectorXd& gradient,
             Eigen::MatrixXd& hessian) const;

  // What may touch the floor: nothing without one.
  [[nodiscard]] std::span<const SkinPoint> floor_points() const { return points_; }

 private:
  struct SpherePair {
    int a = 0, b = 0;
    double reach = 0;  // metres: nearer centres cost
  };
  // The spheres of two bones, which are looked at where the bones' bounds touch.
  struct BonePair {
    int a = 0, b = 0;
    std::vector<SpherePair> spheres;
  };
  template <typename Visit>
  void for_each_overlap(const PointMotion& motion, const Visit& visit) const;
  double add_penetration(const PointMotion& motion, Eigen::VectorXd& gradient, Eigen::MatrixXd& hessian) const;
  double add_floor(const PointMotion& motion, Eigen::VectorXd& gradient, Eigen::MatrixXd& hessian) const;

  std::shared_ptr<const BodyModel> body_;
  std::vector<CollisionSphere> spheres_;
  std::vector<CollisionSphere> bounds_;  // [J] a sphere about all spheres of a bone
  std::vector<BonePair> pairs_;
  std::vector<SkinPoint> points_;  // none without a floor
};

}  // namespace silpose
