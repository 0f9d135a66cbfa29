#include "silpose/render/projected_skin.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "silpose/base/check.h"

namespace silpose {
namespace {

std::span<const uint16_t> joints_of(const SkinWeights& skin, size_t vertex) {
  return std::span(skin.joint_idx).subspan(skin.row_start[vertex], skin.row_start[vertex + 1] - skin.row_start[vertex]);
}

bool is_finite(std::span<const double> pose) {
  return std::ranges::all_of(pose, [](double value) { return std::isfinite(value); });
}

}  // namespace

ProjectedSkin::ProjectedSkin(const BodyModel& body, const PinholeCamera& camera) : body_(&body), camera_(&camera) {
  const SkinWeights& skin = body.skin;
  const size_t num_vertices = body.rest.vertices.size();
  check(skin.row_start.size() == num_vertices + 1, "ProjectedSkin: {} vertices, weights of {}", num_vertices,
        skin.row_start.size());
  std::vector<uint32_t> order(num_vertices);
  std::iota(order.begin(), order.end(), 0u);
  std::ranges::stable_sort(order, [&](uint32_t a, uint32_t b) {
    return std::ranges::lexicographical_compare(joints_of(skin, a), joints_of(skin, b));
  });

  std::vector<uint32_t> slot_of_vertex(num_vertices);
  for (size_t first = 0; first < num_vertices; first += kChunkLanes) {
    const auto begin = static_cast<uint32_t>(entries_.size());
    for (size_t lane = 0; lane < kChunkLanes; ++lane) {
      // Lanes past the end repeat the last vertex, so that they change neither bounds nor what is seen.
      const size_t position = std::min(first + lane, num_vertices - 1);
      const uint32_t vertex = order[position];
      vertex_of_slot_.push_back(vertex);
      if (first + lane < num_vertices) slot_of_vertex[vertex] = static_cast<uint32_t>(position);
      const Eigen::Vector3f& rest = body.rest.vertices[vertex];
      for (uint32_t i = skin.row_start[vertex]; i < skin.row_start[vertex + 1]; ++i) {
        auto joint = std::find(entry_joint_.begin() + begin, entry_joint_.end(), skin.joint_idx[i]);
        if (joint == entry_joint_.end()) {
          entries_.push_back({});
          joint = entry_joint_.insert(joint, skin.joint_idx[i]);
        }
        SkinEntry& entry = entries_[static_cast<size_t>(joint - entry_joint_.begin())];
        entry.x.lane[lane] += skin.weight[i] * rest.x();
        entry.y.lane[lane] += skin.weight[i] * rest.y();
        entry.z.lane[lane] += skin.weight[i] * rest.z();
        entry.w.lane[lane] += skin.weight[i];
      }
    }
    chunks_.push_back({begin, static_cast<uint32_t>(entries_.size())});
  }
  for (const Face& face : body.rest.faces) {
    faces_.push_back({slot_of_vertex[face[0]], slot_of_vertex[face[1]], slot_of_vertex[face[2]]});
  }
}

void ProjectedSkin::set_matrices(std::span<const double> pose, Scratch& scratch) const {
  const auto num_joints = static_cast<size_t>(body_->skeleton.num_joints());
  scratch.world_from_joint.resize(num_joints);
  scratch.matrices.resize(12 * num_joints);
  body_->skeleton.forward_kinematics(pose, scratch.world_from_joint);

  Eigen::Matrix3d intrinsics = Eigen::Matrix3d::Identity();
  if (!camera_->has_distortion()) intrinsics << camera_->fx, 0, camera_->cx, 0, camera_->fy, camera_->cy, 0, 0, 1;
  const Eigen::Matrix3d rotation = intrinsics * camera_->cam_from_world.rotation;
  const Eigen::Vector3d translation = intrinsics * camera_->cam_from_world.translation;
  for (size_t j = 0; j < num_joints; ++j) {
    const Rigid3 world_from_rest = scratch.world_from_joint[j] * body_->joint_from_rest[j];
    Eigen::Matrix<double, 3, 4> matrix;
    matrix << rotation * world_from_rest.rotation, rotation * world_from_rest.translation + translation;
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 4; ++column) {
        scratch.matrices[12 * j + static_cast<size_t>(4 * row + column)] = static_cast<float>(matrix(row, column));
      }
    }
  }
}

SkinView ProjectedSkin::view(const Scratch& scratch) const {
  return {.chunks = chunks_.data(),
          .num_chunks = chunks_.size(),
          .entries = entries_.data(),
          .entry_joint = entry_joint_.data(),
          .matrices = scratch.matrices.data()};
}

bool ProjectedSkin::project_to_grid(std::span<const double> pose, const Window& window, Scratch& scratch) const {
  if (!camera_->has_distortion() && is_finite(pose)) {
    set_matrices(pose, scratch);
    scratch.points.resize(num_slots());
    scratch.some_unseen = false;
    if (skin_and_round(view(scratch), GridAxis(window.x0, window.scale_x), GridAxis(window.y0, window.scale_y),
                       scratch.points.data())) {
      return true;
    }
  }
  if (!project(pose, scratch)) return false;
  if (!scratch.some_unseen) round(window, scratch);
  return true;
}

bool ProjectedSkin::project_to_pixels(std::span<const double> pose, std::span<Eigen::Vector2f> pixels,
                                      Scratch& scratch) const {
  check(pixels.size() == num_slots(), "ProjectedSkin: {} slots, room for {}", num_slots(), pixels.size());
  if (!camera_->has_distortion() && is_finite(pose)) {
    set_matrices(pose, scratch);
    scratch.some_unseen = false;
    if (skin_to_pixels(view(scratch), pixels.data()->data())) return true;
  }
  if (!project(pose, scratch)) return false;
  Eigen::Vector2f* pixel = pixels.data();
  for (size_t c = 0; c < chunks_.size(); ++c) {
    for (size_t lane = 0; lane < kChunkLanes; ++lane) {
      *pixel++ = {scratch.x[c].lane[lane], scratch.y[c].lane[lane]};
    }
  }
  return true;
}

bool ProjectedSkin::project(std::span<const double> pose, Scratch& scratch) const {
  if (!is_finite(pose)) return false;
  set_matrices(pose, scratch);
  const size_t num_chunks = chunks_.size();
  scratch.x.resize(num_chunks);
  scratch.y.resize(num_chunks);
  scratch.depth.resize(num_chunks);
  skin_and_project(view(scratch), scratch.x.data(), scratch.y.data(), scratch.depth.data());
  if (camera_->has_distortion()) {
    LensFloats lens{.fx = static_cast<float>(camera_->fx),
                    .fy = static_cast<float>(camera_->fy),
                    .cx = static_cast<float>(camera_->cx),
                    .cy = static_cast<float>(camera_->cy),
                    .k = {}};
    std::ranges::transform(camera_->distortion, lens.k, [](double value) { return static_cast<float>(value); });
    distort_points(lens, num_chunks, scratch.x.data(), scratch.y.data());
  }
  const ProjectionBounds bounds =
      bounds_of_points(num_chunks, scratch.x.data(), scratch.y.data(), scratch.depth.data());
  scratch.some_unseen = !bounds.all_seen;
  if (scratch.some_unseen) return leave_out_unseen(scratch);
  scratch.bounds = {bounds.x0, bounds.y0, bounds.x1, bounds.y1};
  return true;
}

bool ProjectedSkin::leave_out_unseen(Scratch& scratch) const {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  PixelBounds bounds{kInfinity, kInfinity, -kInfinity, -kInfinity};
  for (size_t slot = 0; slot < num_slots(); ++slot) {
    const size_t chunk = slot / kChunkLanes, lane = slot % kChunkLanes;
    float& x = scratch.x[chunk].lane[lane];
    const float y = scratch.y[chunk].lane[lane];
    if (!(scratch.depth[chunk].lane[lane] >= static_cast<float>(PinholeCamera::kNear))) {
      x = std::numeric_limits<float>::quiet_NaN();
      continue;
    }
    bounds = {std::min<double>(bounds.x0, x), std::min<double>(bounds.y0, y), std::max<double>(bounds.x1, x),
              std::max<double>(bounds.y1, y)};
  }
  scratch.bounds = bounds;
  return bounds.x0 <= bounds.x1;
}

void ProjectedSkin::round(const Window& window, Scratch& scratch) const {
  const GridAxis x_axis(window.x0, window.scale_x), y_axis(window.y0, window.scale_y);
  scratch.points.resize(num_slots());
  round_points(x_axis, y_axis, chunks_.size(), scratch.x.data(), scratch.y.data(), scratch.points.data());
}

}  // namespace silpose
