#include "silpose/render/pose_projector.h"

#include "silpose/render/silhouette.h"

namespace silpose {

PoseProjector::PoseProjector(std::shared_ptr<const BodyModel> body, const PinholeCamera& camera)
    : body_(std::move(body)), camera_(camera), skin_(*body_, camera_) {}

void PoseProjector::cut(std::span<const double> pose, Scratch& scratch) const {
  const std::vector<Eigen::Vector3f> vertices = skin_vertices(*body_, pose);
  scratch.vertices_in_world_.clear();
  for (const uint32_t vertex : skin_.vertex_of_slot()) scratch.vertices_in_world_.push_back(vertices[vertex]);
  project_mesh(camera_, scratch.vertices_in_world_, skin_.faces(), scratch.cut_);
}

bool PoseProjector::project(std::span<const double> pose, Scratch& scratch) const {
  if (!skin_.project(pose, scratch.projected_)) return false;
  if (!scratch.some_unseen()) return true;
  cut(pose, scratch);
  const auto bounds = pixel_bounds(scratch.cut_.pixels);
  scratch.projected_.bounds = bounds.value_or(PixelBounds{});
  return bounds.has_value();
}

void PoseProjector::round(const Window& window, Scratch& scratch) const {
  if (!scratch.some_unseen()) {
    skin_.round(window, scratch.projected_);
    return;
  }
  scratch.projected_.points.resize(scratch.cut_.pixels.size());
  round_to_grid(scratch.cut_.pixels, window, scratch.projected_.points);
}

bool PoseProjector::project_to_grid(std::span<const double> pose, const Window& window, Scratch& scratch) const {
  if (!skin_.project_to_grid(pose, window, scratch.projected_)) return false;
  if (scratch.some_unseen()) {
    cut(pose, scratch);
    round(window, scratch);
  }
  return true;
}

void PoseProjector::inverse_depths(const Scratch& scratch, std::vector<float>& inverse_depth) const {
  inverse_depth.clear();
  if (!scratch.some_unseen()) {
    for (const ChunkFloats& chunk : scratch.projected_.depth) {
      for (const float depth : chunk.lane) inverse_depth.push_back(1 / depth);
    }
    return;
  }
  for (const Eigen::Vector3f& vertex : scratch.vertices_in_world_) {
    inverse_depth.push_back(static_cast<float>(1 / (camera_.cam_from_world * vertex.cast<double>()).z()));
  }
  for (const auto& vertex : scratch.cut_.cut_vertices) inverse_depth.push_back(static_cast<float>(1 / vertex.depth));
}

}  // namespace silpose
