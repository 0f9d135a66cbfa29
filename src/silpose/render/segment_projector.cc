#include "silpose/render/segment_projector.h"

#include <algorithm>

namespace silpose {
namespace {

constexpr double kMargin = 0.05;  // of the image's view, on each side: room for the width of lines
constexpr int kPieces = 48;       // of a distorted segment

}  // namespace

SegmentProjector::SegmentProjector(const PinholeCamera& camera) : camera_(camera), view_(camera, kMargin) {}

std::vector<Eigen::Vector2d> SegmentProjector::operator()(const Eigen::Vector3d& from,
                                                          const Eigen::Vector3d& to) const {
  const Eigen::Vector3d a = camera_.cam_from_world * from, b = camera_.cam_from_world * to;
  double begin = 0, end = 1;  // the part of it that is inside
  for (const Eigen::Vector4d& half_space : view_.half_spaces) {
    const double at_a = half_space.dot(a.homogeneous()), at_b = half_space.dot(b.homogeneous());
    if (at_a < 0 && at_b < 0) return {};
    if (at_a < 0) begin = std::max(begin, at_a / (at_a - at_b));
    if (at_b < 0) end = std::min(end, at_a / (at_a - at_b));
  }
  if (begin >= end) return {};
  // A line stays a line up to the lens: points on it are taken there, where they lie evenly in the image.
  const Eigen::Vector2d first = (a + begin * (b - a)).hnormalized(), last = (a + end * (b - a)).hnormalized();
  const int pieces = camera_.has_distortion() ? kPieces : 1;
  std::vector<Eigen::Vector2d> pixels;
  pixels.reserve(static_cast<size_t>(pieces) + 1);
  for (int i = 0; i <= pieces; ++i) {
    const Eigen::Vector2d slope = first + (last - first) * (i / double(pieces));
    pixels.push_back(camera_.project_from_camera(slope.homogeneous()));
  }
  return pixels;
}

}  // namespace silpose
