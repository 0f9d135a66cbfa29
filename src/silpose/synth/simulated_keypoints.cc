#include "silpose/synth/simulated_keypoints.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "silpose/base/check.h"
#include "silpose/base/rng.h"
#include "silpose/shape/keypoint_axes.h"

namespace silpose {
namespace {

using Eigen::Vector3d;

// Half of the variance is the same in all frames. [guess: the network's bias per person and view was seen to be as
// large as what changes from frame to frame]
constexpr double kShareOfBias = 0.5;
constexpr double kPlaceDeviation = 0.02;  // of the body's height in the image, each axis [guess]
constexpr std::array<const char*, 2> kSides = {"right_", "left_"};
constexpr uint64_t kBiasStream = 1ULL << 32;  // no frame has it

Vector3d normal3(Rng& rng) {
  const double x = rng.normal(), y = rng.normal(), z = rng.normal();
  return {x, y, z};
}

// The segments whose directions are drawn, by name.
std::vector<std::string> segment_names() {
  std::vector<std::string> names = {"trunk", "hips", "shoulders"};
  for (const std::string side : kSides) {
    for (const LimbSegment& segment : kLimbSegments) names.push_back(side + std::string(segment.from));
  }
  return names;
}

std::vector<std::string> keypoint_names() {
  std::vector<std::string> names;
  for (const std::string side : kSides) {
    for (const char* const joint : {"thigh", "shin", "foot", "upper_arm", "forearm", "hand"}) {
      names.push_back(side + joint);
    }
  }
  return names;
}

}  // namespace

SimulatedKeypoints::SimulatedKeypoints(const SyntheticSequence& sequence, int camera_idx, uint64_t seed)
    : sequence_(&sequence), camera_idx_(camera_idx), seed_(seed), landmark_names_(landmark_names(*sequence.body)) {
  check(camera_idx >= 0 && camera_idx < std::ssize(sequence.cameras), "SimulatedKeypoints: camera {} of {}", camera_idx,
        sequence.cameras.size());
  Rng rng(seed, kBiasStream, static_cast<uint64_t>(camera_idx));
  for (const std::string& name : segment_names()) direction_bias_[name] = normal3(rng);
  for (const std::string& name : keypoint_names()) {
    check(std::ranges::count(landmark_names_, name) == 1, "SimulatedKeypoints: the body has no joint {}", name);
    const Vector3d bias = normal3(rng);
    place_bias_[name] = bias.head<2>();
  }
}

SimulatedKeypoints::Seen SimulatedKeypoints::draw(int frame, const Box& box) const {
  Seen seen;
  const std::span<const double> pose = pose_of_frame(*sequence_, frame);
  if (pose.empty()) return seen;
  const PinholeCamera& camera = sequence_->cameras[static_cast<size_t>(camera_idx_)];
  const std::vector<Vector3d> positions = landmark_positions(*sequence_->body, pose);
  std::map<std::string, Vector3d> x;
  for (size_t i = 0; i < positions.size(); ++i) x[landmark_names_[i]] = positions[i];

  seen.keypoints_3d.centre_x = box.x + 0.5 * box.width;
  seen.keypoints_3d.centre_y = box.y + 0.5 * box.height;
  const Eigen::Matrix3d points_from_world = world_from_keypoints(camera, seen.keypoints_3d).transpose();
  Rng rng(seed_, static_cast<uint64_t>(frame), static_cast<uint64_t>(camera_idx_));
  const double of_bias = std::sqrt(kShareOfBias), of_frame = std::sqrt(1 - kShareOfBias);
  // The vector as the network sees it.
  const auto draw_vector = [&](const std::string& segment, const Vector3d& true_vector, const DirectionError& error,
                               const Vector3d& forward) -> Vector3d {
    const Vector3d deviations(error.in_image, error.in_image, error.in_depth);
    const Vector3d off = of_bias * direction_bias_.at(segment) + of_frame * normal3(rng);
    const Vector3d direction =
        (points_from_world * true_vector).stableNormalized() + forward + deviations.cwiseProduct(off);
    return true_vector.norm() * direction.stableNormalized();
  };
  const Vector3d hips = x.at("left_thigh") - x.at("right_thigh");
  const Vector3d shoulders = x.at("left_upper_arm") - x.at("right_upper_arm");
  const Vector3d trunk =
      (x.at("left_upper_arm") + x.at("right_upper_arm") - x.at("left_thigh") - x.at("right_thigh")) / 2;
  const Vector3d forward = points_from_world * (hips + shoulders).cross(trunk).stableNormalized();

  std::map<std::string, Vector3d> drawn;
  const Vector3d hips_drawn = draw_vector("hips", hips, kHipsError, Vector3d::Zero());
  const Vector3d shoulders_drawn = draw_vector("shoulders", shoulders, kShouldersError, Vector3d::Zero());
  const Vector3d trunk_drawn = draw_vector("trunk", trunk, kTrunkError, Vector3d::Zero());
  drawn["left_thigh"] = hips_drawn / 2, drawn["right_thigh"] = -hips_drawn / 2;
  drawn["left_upper_arm"] = trunk_drawn + shoulders_drawn / 2;
  drawn["right_upper_arm"] = trunk_drawn - shoulders_drawn / 2;
  for (const std::string side : kSides) {
    for (const LimbSegment& segment : kLimbSegments) {
      const std::string from = side + std::string(segment.from), to = side + std::string(segment.to);
      drawn[to] =
          drawn.at(from) + draw_vector(from, x.at(to) - x.at(from), segment.error, segment.forward_bias * forward);
    }
  }
  // The body's height in the image, as far away as it is.
  const double depth = (camera.cam_from_world * positions.front()).z();
  const double place_deviation = kPlaceDeviation * camera.fy * sequence_->body->height_m / std::max(depth, 0.1);
  for (const std::string& name : keypoint_names()) {
    const Vector3d& place = drawn.at(name);
    seen.keypoints_3d.points.push_back({.name = name, .x = {place.x(), place.y(), place.z()}});
    const Eigen::Vector2d off = of_bias * place_bias_.at(name) + of_frame * Eigen::Vector2d(normal3(rng).head<2>());
    if (const auto pixel = camera.project(x.at(name))) {
      const Eigen::Vector2d at = *pixel + place_deviation * off;
      seen.keypoints_2d.push_back({.name = name, .x = at.x(), .y = at.y()});
    }
  }
  return seen;
}

}  // namespace silpose
