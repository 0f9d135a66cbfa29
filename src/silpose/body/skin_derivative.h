// SkinDerivative: how vertices of a skinned mesh move with the pose, along given directions: d (g . x) / d pose.
// Weights and directions are summed at the joints first and carried to the root once, so that a sum over many vertices
// costs no more than one pass over the tree.
// Threads: one thread per object.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "silpose/body/body_model.h"

namespace silpose {

class SkinDerivative {
 public:
  explicit SkinDerivative(const BodyModel& body);  // keeps a reference

  // Takes a pose [D] and forgets what was added.
  void set_pose(std::span<const double> pose);

  // World coordinates of a vertex.
  [[nodiscard]] Eigen::Vector3f position(uint32_t vertex) const;

  // Adds the vertex, seen along `direction` (world coordinates, any length).
  void add(uint32_t vertex, const Eigen::Vector3f& direction);

  // derivative [D] = d (sum of direction . x over what was added) / d pose, and forgets it.
  void take(std::span<float> derivative);

 private:
  const BodyModel* body_;
  std::vector<Rigid3> world_from_joint_;                     // [J]
  std::vector<Eigen::Matrix<float, 3, 4>> world_from_rest_;  // [J]
  std::vector<Eigen::Vector3f> centres_;                     // [J]
  std::vector<Eigen::Vector3f> axes_;                        // [D]
  std::vector<int> parents_;                                 // [J]
  std::vector<Eigen::Vector3f> moments_, directions_;        // [J] sums of x cross g, and of g
  int deepest_ = -1;                                         // joint with something added; -1: none
};

}  // namespace silpose
