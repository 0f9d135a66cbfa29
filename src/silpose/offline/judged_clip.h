// JudgedClip: a clip without the keypoints of frames in which the network exchanged left and right (keypoint_sides.h).
// Only the instants that this changes are copied. Threads: constant after construction.
#pragma once

#include <map>
#include <span>
#include <vector>

#include "silpose/offline/clip_instant.h"

namespace silpose {

class JudgedClip {
 public:
  // The clip must outlive this. Errors: throws std::invalid_argument where observations do not fit the cameras.
  JudgedClip(std::span<const ClipInstant> clip, size_t num_cameras);
  JudgedClip(const JudgedClip&) = delete;
  JudgedClip& operator=(const JudgedClip&) = delete;

  [[nodiscard]] size_t size() const { return instants_.size(); }
  [[nodiscard]] const ClipInstant& operator[](size_t t) const { return *instants_[t]; }
  [[nodiscard]] std::span<const ClipInstant* const> instants() const { return instants_; }  // [T]
  // The probability that the network exchanged left and right, of the camera where it is highest.
  [[nodiscard]] double exchanged(size_t t) const { return exchanged_[t]; }

 private:
  std::vector<const ClipInstant*> instants_;  // [T]
  std::map<size_t, ClipInstant> changed_;     // by instant
  std::vector<double> exchanged_;             // [T]
};

}  // namespace silpose
