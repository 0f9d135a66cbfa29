// SimulatedKeypoints: what a network would find on the body of a SyntheticSequence: directions of segments with errors
// as large as a real network's, partly the same in every frame (the network's bias for this person and view) and partly
// independent in each frame; lengths of segments are true. Places in the image have errors of the same two kinds.
// Threads: const functions are safe; a frame is the same in whatever order they are drawn.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "silpose/image/keypoint2d.h"
#include "silpose/image/keypoints3d.h"
#include "silpose/image/mask.h"
#include "silpose/synth/scene.h"

namespace silpose {

class SimulatedKeypoints {
 public:
  // Of the human skeleton. The sequence must outlive this. Errors: throws std::invalid_argument for no such camera, or
  // a body that lacks a joint that the network sees.
  SimulatedKeypoints(const SyntheticSequence& sequence, int camera_idx, uint64_t seed);

  struct Seen {
    std::vector<Keypoint2D> keypoints_2d;
    Keypoints3D keypoints_3d;
  };
  // Of frame `frame`, counted from the video's first image; the network looks at the middle of `box`. Nothing in the
  // lead-in.
  [[nodiscard]] Seen draw(int frame, const Box& box) const;

 private:
  const SyntheticSequence* sequence_;
  int camera_idx_;
  uint64_t seed_;
  std::vector<std::string> landmark_names_;                // of the body
  std::map<std::string, Eigen::Vector3d> direction_bias_;  // by segment, in deviations
  std::map<std::string, Eigen::Vector2d> place_bias_;      // by keypoint, in deviations
};

}  // namespace silpose
