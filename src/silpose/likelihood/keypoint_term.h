// KeypointTerm: how well poses agree with the keypoints that a network found in one camera's image. Two kinds of
// evidence, both robust:
//   - directions of limb segments in space (shoulder to elbow, hip to knee, ...). They show what a silhouette does not:
//     depth, front and back, left and right. Residual: the pose's unit vector minus the network's.
//   - places in the image, at a low weight, because networks and bodies define joints differently.
// Based on: Student's t by its weights (references.bib: lange1989); the network is BlazePose (bazarevsky2020).
// Threads: constant after construction.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "silpose/body/body_model.h"
#include "silpose/geometry/camera.h"
#include "silpose/image/observation.h"

namespace silpose {

// What an observation is compared by. A camera without keypoints contributes only its silhouette with kBoth, and
// nothing with kKeypoints.
enum class EvidenceKind { kSilhouette, kKeypoints, kBoth };

struct KeypointWeights {
  double directions = 1.25;  // [tuned: nine takes of five people; 1 to 1.5 are alike]
  double places = 0.3;       // [tuned on the same]
};

class KeypointTerm {
 public:
  // Of the keypoints that the body has by name. Directions are those of segments whose two ends are among them.
  KeypointTerm(const BodyModel& body, const PinholeCamera& camera, const Observation& observation,
               const KeypointWeights& weights = {});

  [[nodiscard]] size_t num_places() const { return places_.size(); }
  [[nodiscard]] size_t num_directions() const { return directions_.size(); }
  [[nodiscard]] bool empty() const { return places_.empty() && directions_.empty(); }
  // Whether enough of them are seen to determine the pose of the whole body.
  [[nodiscard]] bool determines_pose() const;

  // -2 log-likelihood of a pose [D], up to a constant. `skeleton` has the joints of the body, and perhaps more DOF.
  [[nodiscard]] double cost(const Skeleton& skeleton, std::span<const double> pose) const;

  // `trust` times the same; adds to `gradient` [D] and `hessian` [D, D] of half of it (Gauss-Newton).
  double add(const Skeleton& skeleton, std::span<const double> pose, double trust, Eigen::VectorXd& gradient,
             Eigen::MatrixXd& hessian) const;

 private:
  struct Point {
    int joint_idx = 0;
    Eigen::Vector3d x_in_joint = Eigen::Vector3d::Zero();
  };
  struct Place {
    size_t point = 0;
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
    double weight = 1;
  };
  // Of the vector sum_i factor_i x_i.
  struct End {
    size_t point = 0;
    double factor = 1;
  };
  struct Direction {
    std::vector<End> ends;
    Eigen::Vector3d observed = Eigen::Vector3d::Zero();  // unit, in the axes of the ray
    Eigen::Vector3d inverse_deviation = Eigen::Vector3d::Zero();
    double weight = 1;
  };
  std::optional<size_t> point_of(const BodyModel& body, std::string_view name);
  void add_places(const BodyModel& body, const Observation& observation, double weight);
  void add_directions(const BodyModel& body, const Keypoints3D& keypoints, double weight);

  size_t num_seen_ = 0;  // in the image, of those that the body has
  PinholeCamera camera_;
  std::vector<Point> points_;
  std::vector<Place> places_;
  std::vector<Direction> directions_;
  Eigen::Matrix3d ray_from_world_ = Eigen::Matrix3d::Identity();  // z: the ray at which the network looked
  double deviation_px_ = 1;
};

// The term of an observation's keypoints. Null for kSilhouette, and where too few keypoints are seen to determine a
// pose. With kKeypoints places have weight 1, since nothing else determines where the body is. Without `places` only
// directions count.
std::shared_ptr<const KeypointTerm> make_keypoint_term(const BodyModel& body, const PinholeCamera& camera,
                                                       const Observation& observation, EvidenceKind kind,
                                                       bool places = true);

}  // namespace silpose
